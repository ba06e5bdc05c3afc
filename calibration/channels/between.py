"""The tick that is not logged: what the loop's law made of the effort between two rows.

The loop runs at 5 ms and every second tick is logged. A winding settles in 2 ms, so the current of a row
belongs to the tick before it, whose effort is the mean of two logged ones plus the gain times how far that
tick's error was from the mean of its neighbours. The errors are known: the absolute encoder says how far
the axis went over the row, the incremental one what of it fell to the logged tick. Without this a set point
that is held over a row, which lifts every other tick of a ramp, passes for a supply that gives way under
load.
"""

from __future__ import annotations

import numpy as np

from calibration.channels.frame import Frame, boxcar, fill
from calibration.readers.run import Array
from calibration.statistics.whitening import Mask

ARCSEC = 4.84813681e-6  # rad
LARGEST = 300.0  # counts: a rate that leaps between two rows says nothing of the tick between
SLOW_ROWS = 25  # 0.25 s: a disagreement of encoders that lasts is no tick's


def unlogged_errors(frame: Frame) -> list[Array]:
    """Error (n,) of the tick before every row less the mean of its neighbours', in counts: by what the axis
    did, and by a set point that was held between the rows.

    The encoders' slow disagreement, a roller that slips or has another diameter, is taken out of the first.
    Zero in open loop and beside gaps; none without set point or velocity.
    """
    setpoint, velocity = frame.get("setpoint"), frame.get("velocity")
    if setpoint is None or velocity is None:
        return []
    per_count = frame.scale["velocity_arcsec_per_count"] * ARCSEC
    counted = velocity * frame.scale["velocity_window_s"] / per_count
    wanted = setpoint * frame.scale["velocity_window_s"] / per_count
    moved = _step(frame, fill(frame.columns["position"], frame.run)[0] / per_count)
    slower = 0.5 * (counted + _before(frame, counted)) - (moved - counted)
    closed = np.isfinite(wanted) & np.isfinite(_before(frame, wanted))
    slower, held = (_known(x, closed) for x in (slower, -0.5 * _step(frame, wanted)))
    return [np.where(slower != 0.0, slower - boxcar(slower, SLOW_ROWS), 0.0), held]


def _known(x: Array, closed: Mask) -> Array:
    """Zero where nothing is known."""
    good = closed & np.isfinite(x)
    good[good] = np.abs(x[good]) < LARGEST
    return np.where(good, x, 0.0)


def _before(frame: Frame, x: Array) -> Array:
    """The row before, NaN at a run's first."""
    out = np.full(len(x), np.nan)
    same = frame.run[1:] == frame.run[:-1]
    out[1:] = np.where(same, x[:-1], np.nan)
    return out


def _step(frame: Frame, x: Array) -> Array:
    """Change from the row before, NaN at a run's first."""
    return x - _before(frame, x)
