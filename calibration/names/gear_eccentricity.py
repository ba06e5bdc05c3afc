"""A gear, shaft or screw that runs out of true."""

from __future__ import annotations

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, SENSORS, Name
from calibration.names.scene import Scene
from calibration.names.sines import stage_lines


def columns(s: Scene) -> list[Candidate]:
    """Sines at the harmonics of every stage without another kind."""
    return stage_lines(s, "gear_eccentricity", default=s.force)


NAME = Name(
    "gear_eccentricity",
    (FORCE, SENSORS),
    columns,
    ("gear_mesh", "bearing_pass", "motor_cogging"),
    "a second speed: a gear keeps its angle, a resonance its frequency; more travel splits close orders",
)
