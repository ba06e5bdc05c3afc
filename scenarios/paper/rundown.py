"""Moment of inertia from run-downs of several speeds, by least squares on the logged counts.

Unknown are the inertia, what the trains damp, and when within a period of the log the command took effect;
friction is the map's, the rest data sheets (coasting.py).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from scenarios.paper.coasting import Drive, coast
from scenarios.paper.friction_map import FrictionFit
from scenarios.paper.log import Array, Log
from scenarios.paper.scales import ARCSEC, LOG_PERIOD_S

INERTIA = (300.0, 10_000.0)
DAMPING = (300.0, 60_000.0)
LATE_S = (0.0, 0.025)
"""Bounds of the three: kg m2; N m s/rad of one train; s."""
SLOWEST = 60.0
"""arcsec/s: below, bristles move more than they slide, which the map's curve does not know."""
SPAN_S = 0.1
"""s: the axis is slower than that within 0.08 s."""


@dataclass(frozen=True)
class Inertia:
    """Result: inertia of the axis with rotors, kg m2; damping of one train, N m s/rad; from the command
    to the moment it took effect, s; rms of the misfit, counts."""

    inertia: float
    damping: float
    late_s: float
    misfit: float


def fit_run_downs(
    logs: Sequence[Log], setpoints: Sequence[float], friction: FrictionFit, sheet: Drive
) -> Inertia:
    """Return the inertia that explains all run-downs together.

    logs: each begins with the command "effort 0". setpoints: steady speeds before, arcsec/s, with sign. Both
    directions should be there: their mean is free of the axis' balance. Raises ValueError when no sample is
    fast enough to be used.
    """
    samples = min(round(SPAN_S / LOG_PERIOD_S), *(log.t_s.size for log in logs))
    signs = np.sign(np.asarray(setpoints, dtype=np.float64))
    read = np.array([sign * log.rate[:samples] for sign, log in zip(signs, logs, strict=True)])
    counts = np.array([sign * log.counts[:samples] for sign, log in zip(signs, logs, strict=True)])
    speeds = np.abs(np.asarray(setpoints, dtype=np.float64)) * ARCSEC
    used = np.minimum.accumulate(read, axis=1) > SLOWEST
    if used.sum() < 6:
        raise ValueError(f"only {used.sum()} samples of the run-downs are usable; at least 6 are needed")

    def model(x: Array) -> Array:
        inertia, damping = np.exp(x[:2])
        return coast(sheet, friction, float(inertia), float(damping), float(x[2]), speeds, samples)

    # a run of 2 deg/s has larger errors than one of 600 arcsec/s: shares of the set point, and the quantum
    scale = (1.0 + 0.01 * np.abs(counts[:, :1])) * np.ones_like(counts)

    def misfit(x: Array) -> Array:
        return np.asarray(((model(x) - counts) / scale)[used], dtype=np.float64)

    low = [np.log(INERTIA[0]), np.log(DAMPING[0]), LATE_S[0]]
    high = [np.log(INERTIA[1]), np.log(DAMPING[1]), LATE_S[1]]
    best = None
    for late in (0.005, 0.012):
        start = [np.log(1500.0), np.log(5000.0), late]
        found = least_squares(
            misfit,
            start,
            bounds=(low, high),
            loss="soft_l1",
            x_scale=[0.1, 1.0, 0.003],
            diff_step=[1e-3, 1e-2, 0.02],
        )
        if best is None or found.cost < best.cost:
            best = found
    assert best is not None
    inertia, damping = (float(v) for v in np.exp(best.x[:2]))
    return Inertia(inertia, damping, float(best.x[2]), float(np.sqrt(np.mean(misfit(best.x) ** 2))))
