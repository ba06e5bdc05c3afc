"""Moment of inertia from run-downs of several speeds, by least squares on the logged counts.

Unknown are the inertia, what the trains damp, and when within a period of the log the command took effect.
Friction is the map's, the rest data sheets (coasting.py).
"""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import least_squares

from scenarios.studies.paper.coasting import Coasting, Drive, coast
from scenarios.studies.paper.friction_map import FrictionFit
from scenarios.studies.paper.log import Array, Log
from scenarios.studies.paper.scales import ARCSEC, LOG_PERIOD_S

INERTIA = (300.0, 10_000.0)
DAMPING = (300.0, 60_000.0)
LATE_S = (0.0, 0.025)
"""Bounds of the three: kg m2; N m s/rad of one train; s."""
SLOWEST = 60.0
"""arcsec/s: below, bristles move more than they slide, which the map's curve does not know."""
SPAN_S = 0.1
"""s: the axis is slower than that within 0.08 s."""


def fit_run_downs(
    logs: Sequence[Log], setpoints: Sequence[float], friction: FrictionFit, sheet: Drive
) -> Coasting:
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
        return coast(sheet, friction, _coasting(x), speeds, samples)

    # a run of 2 deg/s has larger errors than one of 600 arcsec/s: shares of the set point, and the quantum
    scale = (1.0 + 0.01 * np.abs(counts[:, :1])) * np.ones_like(counts)

    def misfit(x: Array) -> Array:
        return np.asarray(((model(x) - counts) / scale)[used], dtype=np.float64)

    low = [np.log(INERTIA[0]), np.log(DAMPING[0]), LATE_S[0]]
    high = [np.log(INERTIA[1]), np.log(DAMPING[1]), LATE_S[1]]
    scales = {"x_scale": [0.1, 1.0, 0.003], "diff_step": [1e-3, 1e-2, 0.02]}
    starts = ([np.log(1500.0), np.log(5000.0), late] for late in (0.005, 0.012))
    found = [least_squares(misfit, x, bounds=(low, high), loss="soft_l1", **scales) for x in starts]
    return _coasting(min(found, key=lambda each: each.cost).x)


def _coasting(x: Array) -> Coasting:
    """x: logarithms of inertia and damping, and the delay, s."""
    inertia, damping = np.exp(x[:2])
    return Coasting(inertia=float(inertia), damping=float(damping), late_s=float(x[2]))
