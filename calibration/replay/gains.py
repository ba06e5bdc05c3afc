"""The controller's gains as the log shows them: effort over stretches against the summed velocity error."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from calibration.channels.frame import Frame, fill
from calibration.readers.drive import ARCSEC
from calibration.readers.run import Array
from calibration.statistics.regression import solve
from calibration.statistics.whitening import Mask

LAG_S = 0.25  # effort differences over this long: the summed error is then far above one count
FULL = 0.98  # of full effort: beyond, the integrator is held at its end
LEAST_ROWS = 500
AGREE = 6.0  # median deviations: rows beyond are another mode of the controller, or a jump of the set point


@dataclass(frozen=True)
class Gains:
    """Proportional and integral gain, PWM steps (1/3000) per count in 5 ms, and where they come from."""

    kp: float
    ki: float
    source: str


def identify(frame: Frame, rows: Mask) -> Gains | None:
    """Gains of U(t) - U(t - L) = Kp (e(t) - e(t - L)) + Ki (sum of e over both ticks of every row between).

    The sum of the error follows from the absolute encoder, so no difference of quantised counts is needed.
    None where `rows` hold too little closed loop in motion.
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
    late = np.abs(effort) > FULL * frame.scale["effort_full_scale"]
    busy = np.cumsum((late | ~trusted | ~np.isfinite(error)).astype(float))

    def over(x: Array) -> Array:
        return np.asarray(x[lag:] - x[:-lag])

    y = over(effort)
    x = np.column_stack([over(error), over(wanted - position) / count])
    good = np.isfinite(y) & np.isfinite(x).all(axis=1) & (over(busy) == 0)
    good &= (frame.run[lag:] == frame.run[:-lag]) & rows[lag:] & rows[:-lag]
    good &= (np.abs(over(np.nan_to_num(setpoint))) < 0.5 * count / window) & (effort[lag:] != 0)
    if good.sum() < LEAST_ROWS:
        return None
    beta = solve(x[good], y[good])
    for _ in range(8):
        left = np.abs(y - x @ beta)
        inside = good & (left <= AGREE * max(float(np.median(left[good])), 0.5))
        if inside.sum() < LEAST_ROWS:
            return None
        beta = solve(x[inside], y[inside])
    kp, ki = float(beta[0]), float(beta[1])
    if not (0.0 < kp < 100.0 and 0.0 < ki < 100.0):
        return None
    return Gains(kp, ki, "identified from set point, velocity and effort")
