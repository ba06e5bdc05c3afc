"""Teeth that mesh unevenly."""

from __future__ import annotations

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, SENSORS, Name
from calibration.names.scene import Scene
from calibration.names.sines import stage_lines


def columns(s: Scene) -> list[Candidate]:
    """Sines at the stages that are declared as a mesh."""
    return stage_lines(s, "gear_mesh")


NAME = Name(
    "gear_mesh",
    (FORCE, SENSORS),
    columns,
    ("gear_eccentricity",),
    "a second speed, and travel enough to split it from the neighbouring order",
)
