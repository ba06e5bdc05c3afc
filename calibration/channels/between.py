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

from calibration.channels.frame import Frame, fill
from calibration.readers.run import Array

ARCSEC = 4.84813681e-6  # rad
LARGEST = 300.0  # counts: a rate that leaps between two rows says nothing of the tick between


def unlogged_errors(frame: Frame) -> list[Array]:
    """Error (n,) of the tick before every row less the mean of its neighbours', in counts.

    Two of them: the set point followed a ramp, or was held, between the rows. Zero in open loop and beside
    gaps; none without set point or velocity.
    """
    setpoint, velocity = frame.get("setpoint"), frame.get("velocity")
    if setpoint is None or velocity is None:
        return []
    per_count = frame.scale["velocity_arcsec_per_count"] * ARCSEC
    counted = velocity * frame.scale["velocity_window_s"] / per_count
    wanted = setpoint * frame.scale["velocity_window_s"] / per_count
    moved = _step(frame, fill(frame.columns["position"], frame.run)[0] / per_count)
    slower = 0.5 * (counted + _before(frame, counted)) - (moved - counted)
    held = -0.5 * _step(frame, wanted)
    closed = np.isfinite(wanted) & np.isfinite(_before(frame, wanted))
    out = []
    for error in (slower, slower + held):
        known = closed & np.isfinite(error)
        out.append(np.where(known & (np.abs(np.where(known, error, 0.0)) < LARGEST), error, 0.0))
    return [np.nan_to_num(x) for x in out]


def _before(frame: Frame, x: Array) -> Array:
    """The row before, NaN at a run's first."""
    out = np.full(len(x), np.nan)
    same = frame.run[1:] == frame.run[:-1]
    out[1:] = np.where(same, x[:-1], np.nan)
    return out


def _step(frame: Frame, x: Array) -> Array:
    """Change from the row before, NaN at a run's first."""
    return x - _before(frame, x)
