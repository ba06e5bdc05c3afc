"""A line over position at a period of no stage."""

from __future__ import annotations

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, SENSORS, Name
from calibration.names.scene import Scene
from calibration.names.sines import free_lines


def columns(s: Scene) -> list[Candidate]:
    """Lines that stand out of the residual's spectrum over position."""
    return free_lines(s)


NAME = Name(
    "bearing_pass",
    (FORCE, SENSORS),
    columns,
    ("gear_eccentricity", "gear_mesh", "motor_cogging"),
    "twice the travel: the order stands clear of every gear; or declare the gears",
)
