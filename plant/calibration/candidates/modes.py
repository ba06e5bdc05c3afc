"""Fixed-frequency effects: a second mass on a spring, and pick-up at fixed Hz."""

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
            out.append(Candidate("structural_mode", "time", shape(np.array([f0, zeta])), (("inertia_2", "kg m2"),),
                                 fixed={"frequency": (f0, "Hz"), "damping": (zeta, "1")}, sign=1, frequency=f0,
                                 shape=shape, steps=(0.03 * f0, 0.3 * zeta)))
    return out


def _resonance(acceleration: Array, period_s: float) -> Callable[[Array], Array]:
    def shape(p: Array) -> Array:
        from scipy.signal import bilinear, lfilter

        w, zeta = 2 * np.pi * max(float(p[0]), 0.3), max(float(p[1]), 1e-3)
        b, a = bilinear([2 * zeta * w, w * w], [1.0, 2 * zeta * w, w * w], fs=1 / period_s)
        return np.asarray(lfilter(b, a, acceleration))[:, None]

    return shape


def fixed_lines(c: Context, e: Array, rows: Array, period_s: float, count: int = 3) -> list[Candidate]:
    """The strongest lines at fixed Hz: nothing of the catalogue keeps its frequency at every speed but a mode."""
    x = np.where(rows, e, 0.0)
    power = np.abs(np.fft.rfft(x)) ** 2
    hertz = np.fft.rfftfreq(len(x), period_s)
    power[hertz < 0.5] = 0
    out = []
    for _ in range(count):
        k = int(np.argmax(power))
        f0 = float(hertz[k])
        power[max(k - 3, 0):k + 4] = 0
        phase = 2 * np.pi * f0 * c.t
        out.append(Candidate("unknown", "time", np.column_stack([np.cos(phase), np.sin(phase)]), (("amplitude", c.unit),),
                             kind="line", frequency=f0))
    return out
