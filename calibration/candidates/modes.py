"""Fixed-frequency effects: a second mass on a spring."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from calibration.candidates.candidate import Candidate
from calibration.channels.motion import Motion
from calibration.readers.run import Array

# Hz, 4.5 % apart: a mode of 2 % damping is as wide
FREQUENCIES = tuple(float(x) for x in np.geomspace(1.8, 14.2, 48))


def structural_modes(m: Motion, run: NDArray[np.int64]) -> list[Candidate]:
    """Torque of a second mass: its inertia times the axis acceleration seen through its resonance.

    `run` (n,) at full rate. Where the motion is not sound (a gap, the seam between two runs) nothing excites
    it.
    """
    out = []
    period_s = m.period_s / m.width
    shape = _resonance(np.where(m.trusted, m.acceleration, 0.0), run, period_s, m.pick)
    for f0 in FREQUENCIES:
        if f0 > 0.4 / m.period_s:
            continue
        for zeta in (0.008, 0.03):
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
                    steps=(0.01 * f0, 0.3 * zeta),
                )
            )
    return out


def _resonance(
    acceleration: Array, run: NDArray[np.int64], period_s: float, pick: NDArray[np.int64]
) -> Callable[[Array], Array]:
    starts = [*np.flatnonzero(np.diff(run, prepend=run[0] - 1)), len(run)]

    def shape(p: Array) -> Array:
        from scipy.signal import bilinear, lfilter

        zeta = min(max(float(p[1]), 1e-3), 0.15)  # more is no resonance
        w = 2 * np.pi * min(max(float(p[0]), 0.3), 0.45 / period_s)
        x = w * period_s / 2
        # the bilinear transform narrows a resonance at w by this factor, and lowers it by the same
        narrow = np.sin(2 * x) / (2 * x)
        w, zeta = np.tan(x) * 2 / period_s, zeta / narrow
        b, a = bilinear([2 * zeta * w, w * w], [1.0, 2 * zeta * w, w * w], fs=1 / period_s)
        out = [lfilter(b, a, acceleration[i:j]) for i, j in itertools.pairwise(starts)]
        return np.asarray(np.concatenate(out)[pick][:, None] / narrow)

    return shape
