"""Fixed-frequency effects: a second mass on a spring."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from plant.calibration.candidates.candidate import Candidate
from plant.calibration.candidates.context import Context
from plant.calibration.readers.run import Array

FREQUENCIES = (2.0, 2.5, 3.0, 3.6, 4.2, 4.8, 5.4, 6.0, 6.6, 7.2, 7.9, 8.6, 9.4, 10.3, 11.3, 12.5, 14.0)  # Hz


def structural_modes(c: Context, acceleration: Array, period_s: float) -> list[Candidate]:
    """Torque of a second mass: its inertia times the axis acceleration seen through its resonance."""
    out = []
    shape = _resonance(acceleration, period_s)
    for f0 in FREQUENCIES:
        if f0 > 0.4 / period_s:
            continue
        for zeta in (0.01, 0.03, 0.08):
            out.append(
                Candidate(
                    "structural_mode",
                    "time",
                    shape(np.array([f0, zeta])),
                    (("inertia_2", "kg m2"),),
                    fixed={"frequency": (f0, "Hz"), "damping": (zeta, "1")},
                    sign=1,
                    frequency=f0,
                    shape=shape,
                    steps=(0.03 * f0, 0.3 * zeta),
                )
            )
    return out


def _resonance(acceleration: Array, period_s: float) -> Callable[[Array], Array]:
    def shape(p: Array) -> Array:
        from scipy.signal import bilinear, lfilter

        zeta = max(float(p[1]), 1e-3)
        if zeta > 0.15:
            zeta = 0.15  # more is no resonance
        w = 2 / period_s * np.tan(np.pi * min(max(float(p[0]), 0.3), 0.45 / period_s) * period_s)  # prewarped
        b, a = bilinear([2 * zeta * w, w * w], [1.0, 2 * zeta * w, w * w], fs=1 / period_s)
        return np.asarray(lfilter(b, a, acceleration))[:, None]

    return shape
