"""Interpolation between a sensor's lines."""

from __future__ import annotations

from calibration.candidates.candidate import Candidate
from calibration.names.name import SENSORS, Name
from calibration.names.scene import Scene
from calibration.names.sines import stage_lines


def columns(s: Scene) -> list[Candidate]:
    """Sines at the stages that are declared as a sensor's lines."""
    return stage_lines(s, "encoder_subdivision")


NAME = Name(
    "encoder_subdivision",
    (SENSORS,),
    columns,
    ("gear_mesh",),
    "a slow motion over some lines of the sensor",
)
