"""Moment of inertia from the run-down: deceleration and friction characteristic together (paper, Fig. 9,
ref. 17)."""

from dataclasses import dataclass

import numpy as np

from scenarios.paper.friction_map import DataSheet, FrictionFit, drive_torque
from scenarios.paper.log import Array, Log
from scenarios.paper.scales import ARCSEC


@dataclass(frozen=True)
class RunDown:
    """Result: inertia, kg m2 (1e-3 of it is one N mm s2), time to rest, s, and the part of the log that was
    used."""

    inertia: float
    stop_s: float
    t_s: Array
    rate: Array


def fit_inertia(log: Log, friction: FrictionFit, sheet: DataSheet) -> RunDown:
    """Return the inertia that explains a run-down.

    log: begins when the torque was taken away. The equation of motion is integrated, J (w0 - w) = sum of
    (friction(w) - drive torque) dt, and J is its least-squares slope; no derivative of a quantised velocity
    is taken. What current is left (winding decay, freewheel diode) is measured and counted: "copper losses
    ... can be calculated". Used is the part from 95 % down to 15 % of the speed, where friction is known
    from the map and the samples still resolve the motion. Raises ValueError when the axis did not run down
    within the log.
    """
    sign = 1.0 if log.rate[0] >= 0.0 else -1.0
    rate = sign * log.rate * ARCSEC
    start = float(rate[:2].mean())
    rest = np.nonzero(rate < 0.02 * start)[0]
    if start <= 0.0 or not rest.size:
        raise ValueError(
            f"the axis did not come to rest within {log.t_s[-1] - log.t_s[0]:.2f} s: no run-down to fit"
        )
    used = np.nonzero((rate < 0.95 * start) & (rate > 0.15 * start) & (np.arange(rate.size) < rest[0]))[0]
    if used.size < 4:
        raise ValueError(f"only {used.size} samples of the run-down are usable; at least 4 are needed")
    part = slice(int(used[0]), int(used[-1]) + 1)
    t, w = log.t_s[part], rate[part]
    net = friction.torque(w) - sign * drive_torque(log, sheet)[part]
    impulse = np.concatenate([[0.0], np.cumsum(0.5 * (net[1:] + net[:-1]) * np.diff(t))])
    # J (w0 - w) = impulse + c: slope of impulse over w, offset free
    slope = np.polyfit(w, impulse, 1)[0]
    return RunDown(float(-slope), float(log.t_s[rest[0]] - log.t_s[0]), t, w)
