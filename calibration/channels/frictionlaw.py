"""The declared shape of friction along the motion of a drive with one motor."""

from __future__ import annotations

import numpy as np

from calibration.channels.friction import bristle
from calibration.channels.view import View, smooth
from calibration.readers.run import Array


def friction_shape(view: View) -> Array:
    """(n,) at full rate: friction over Coulomb's; the direction of motion where the rig declares no more."""
    law = view.rig.friction_law
    if law is None:
        return view.direction
    if law.bristle_travel is None:
        over = (law.stiction_ratio - 1.0) * np.exp(
            -((np.abs(view.speed) / law.stribeck_speed) ** law.stribeck_exponent)
        )
        return np.asarray(view.direction * (1.0 + over))
    soft = smooth(view.x, view.segment, max(view.sigma / 2, 1.0))  # as the direction is: noise is no travel
    return bristle(
        soft,
        np.concatenate([[True], np.diff(view.segment) != 0]),
        view.period_s,
        law.stiction_ratio,
        law.stribeck_speed,
        1.0 / law.bristle_travel,
        law.stribeck_exponent,
    )
