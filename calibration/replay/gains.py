"""The controller's gains as the log shows them: effort over stretches against the summed velocity error."""

from dataclasses import dataclass

import numpy as np

from calibration.arrays import Array, Mask
from calibration.balances.frame import Frame, fill
from calibration.balances.thresholds import AT_LIMIT
from calibration.replay.thresholds import AGREE, LAG_S, LARGEST_GAIN, LEAST_LOOP_ROWS, ROBUST_ROUNDS
from calibration.statistics.regression import solve
from plant.units import ARCSEC


@dataclass(frozen=True)
class Gains:
    """Proportional and integral gain, PWM steps (1/3000) per count in 5 ms."""

    kp: float
    ki: float


def identify(frame: Frame, rows: Mask) -> Gains | None:
    """Gains of U(t) - U(t - L) = Kp (e(t) - e(t - L)) + Ki (S - r X).

    S is the sum of e over both ticks of every row between. This sum follows from the absolute encoder, so
    no difference of quantised counts is needed. X is the way in counts, r what the roller that the loop
    counts has of it too much. None where `rows` hold too little closed loop in motion.
    """
    setpoint, velocity = frame.get("setpoint"), frame.get("velocity")
    if setpoint is None or velocity is None:
        return None
    lag = round(LAG_S / frame.period_s)
    window = frame.scale["velocity_window_s"]
    count = frame.scale["velocity_arcsec_per_count"] * ARCSEC
    effort = frame.columns["effort"] * frame.scale["effort_full_scale"]
    error = (setpoint - velocity) * window / count
    position, trusted = fill(frame.columns["position"], frame.run)
    wanted = np.cumsum(np.nan_to_num(setpoint)) * frame.period_s
    late = np.abs(effort) > AT_LIMIT * frame.scale["effort_full_scale"]
    bad = late | ~trusted | ~np.isfinite(error)
    busy = np.cumsum(bad.astype(float))

    def over(x: Array) -> Array:
        return np.asarray(x[lag:] - x[:-lag])

    y = over(effort)
    x = np.column_stack([over(error), over(wanted - position) / count, over(position) / count])
    good = np.isfinite(y) & np.isfinite(x).all(axis=1) & (over(busy) == 0) & ~bad[:-lag]
    good &= (frame.run[lag:] == frame.run[:-lag]) & rows[lag:] & rows[:-lag]
    good &= (np.abs(over(np.nan_to_num(setpoint))) < 0.5 * count / window) & (effort[lag:] != 0)
    if good.sum() < LEAST_LOOP_ROWS:
        return None
    beta = solve(x[good], y[good])
    for _ in range(ROBUST_ROUNDS):
        left = np.abs(y - x @ beta)
        inside = good & (left <= AGREE * max(float(np.median(left[good])), 0.5))
        if inside.sum() < LEAST_LOOP_ROWS:
            return None
        beta = solve(x[inside], y[inside])
    found = Gains(*map(float, beta[:2]))
    return found if 0.0 < found.kp < LARGEST_GAIN and 0.0 < found.ki < LARGEST_GAIN else None
