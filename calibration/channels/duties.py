"""Duties of the two motors from the logged effort."""

from __future__ import annotations

import numpy as np

from calibration.channels.frame import Frame
from calibration.readers.run import Array


def counter_share(frame: Frame) -> Array:
    """Counter torque of every row, of the effort."""
    share = np.full(len(frame.t), frame.scale["counter_torque"])
    for k, r in enumerate(frame.runs):
        share[frame.run == k] = r.scales["counter_torque"]
    return share


def duties(frame: Frame, effort: Array) -> dict[str, Array]:
    """Duty of each motor, 0..1: the effort on the one that leads, the counter torque's share on the other."""
    share = counter_share(frame)
    return {
        "a": np.where(effort > 0, effort, -share * effort),
        "b": np.where(effort > 0, share * effort, -effort),
    }
