"""Columns of a drive's logs that hold one number in every row of every file."""

from __future__ import annotations

import numpy as np

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Rig
from calibration.inputs.record import Record
from calibration.readers.run import Array

MOVED = 1e-9  # of the position's largest number: less is how it was rounded


def check_stuck(records: list[Record], rig: Rig) -> None:
    """Raise CalibrationInputError for a response or a measured rate that never changes although the position
    does: it explains nothing, and nothing explains it."""
    position = _all(records, "position")
    if np.ptp(position) <= MOVED * float(np.abs(position).max()):
        return
    wanted = [r.channel for r in rig.responses if r.channel != "position"]
    wanted += [c for c in ("velocity", "acceleration", "motor_a", "motor_b") if c in rig.columns]
    wanted += ["effort"] if rig.motors is not None else []
    for channel in dict.fromkeys(wanted):
        if channel not in rig.columns:
            continue
        values = _all(records, channel)
        if np.ptp(values) == 0:
            raise CalibrationInputError(
                records[0].path,
                f"holds {values[0]:g} in every row while the position moves: it measures nothing",
                None,
                str(rig.columns[channel].column),
            )


def _all(records: list[Record], channel: str) -> Array:
    x = np.concatenate([r.columns[channel] for r in records])
    return np.asarray(x[np.isfinite(x)])
