"""All friction scaled by another preload."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, Name
from calibration.names.onsets import steps
from calibration.names.scene import Scene


def columns(s: Scene) -> list[Candidate]:
    """Friction times a step in time."""
    if not s.declared.get("viscous", 0.0) > 0 or not s.declared.get("coulomb", 0.0) > 0:
        return []
    weight = s.view.direction * s.friction
    if np.std(np.abs(s.view.speed)) < 0.1 * np.mean(np.abs(s.view.speed)):
        return []
    return steps(s, "preload_change", weight, ("relative_change", "1"), 0)


def lacks(s: Scene) -> str:
    """Friction of two kinds."""
    if not s.declared.get("viscous", 0.0) > 0:
        return "viscous friction beside Coulomb's, at two speeds: else a brake looks the same"
    return ""


NAME = Name(
    "preload_change",
    (FORCE,),
    columns,
    ("brake_drag", "friction_warmup"),
    "repeat the same run after a rest: a preload that has changed stays",
    lacks,
)
