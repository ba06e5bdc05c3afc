"""Torque over the motor's angle that needs no current."""

from __future__ import annotations

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, Name
from calibration.names.scene import Scene
from calibration.names.sines import stage_lines


def columns(s: Scene) -> list[Candidate]:
    """Sines at the harmonics of the stages that are declared as a motor's."""
    return stage_lines(s, "motor_cogging")


NAME = Name(
    "motor_cogging",
    (FORCE,),
    columns,
    ("torque_ripple", "gear_eccentricity"),
    "hold the speed and vary the torque: ripple grows, cogging stays",
)
