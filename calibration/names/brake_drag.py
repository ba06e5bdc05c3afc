"""A brake that rubs from some time on."""

from __future__ import annotations

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, Name
from calibration.names.onsets import steps
from calibration.names.scene import Scene


def columns(s: Scene) -> list[Candidate]:
    """A constant force against the motion, from an onset on."""
    return steps(s, "brake_drag", s.view.direction, ("drag", s.unit), 0)


NAME = Name(
    "brake_drag",
    (FORCE,),
    columns,
    ("preload_change", "friction_warmup"),
    "repeat at two speeds: a brake adds the same force at both, a preload scales all friction",
)
