"""Friction that grows with the speed, more or less than was declared."""

from __future__ import annotations

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, Name
from calibration.names.scene import Scene


def columns(s: Scene) -> list[Candidate]:
    """Only where the rig file states the number: what is estimated anyway cannot differ."""
    if "viscous" not in s.view.rig.constants:
        return []
    label = ("viscous_change", f"{s.unit} s/{s.angle_unit}")
    return [Candidate("viscous_change", "velocity", s.at(s.view.speed)[:, None], (label,))]


NAME = Name(
    "viscous_change", (FORCE,), columns, ("load_friction",), "two speeds that differ by a factor of ten"
)
