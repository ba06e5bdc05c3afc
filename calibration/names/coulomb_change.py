"""Friction that does not depend on the speed, more or less than was declared."""

from __future__ import annotations

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, Name
from calibration.names.scene import Scene


def columns(s: Scene) -> list[Candidate]:
    """Only where the rig file states the number: what is estimated anyway cannot differ."""
    if "coulomb" not in s.view.rig.constants:
        return []
    label = ("coulomb_change", s.unit)
    return [Candidate("coulomb_change", "velocity", s.at(s.view.direction)[:, None], (label,))]


NAME = Name("coulomb_change", (FORCE,), columns, ("load_friction",), "slow motion in both directions")
