"""Two sensors whose ratio is not the declared one."""

from __future__ import annotations

from calibration.candidates.candidate import Candidate
from calibration.names.name import SENSORS, Name
from calibration.names.scene import Scene


def columns(s: Scene) -> list[Candidate]:
    """The position less its mean: an error in proportion to the way."""
    if lacks(s):
        return []
    x = s.view.x - s.view.x.mean()
    label = ("error", f"{s.unit}/{s.angle_unit}")
    return [Candidate("roller_ratio", "axis_angle", s.at(x)[:, None], (label,))]


def lacks(s: Scene) -> str:
    """A ratio that is declared and not estimated."""
    r = s.view.response
    return "" if r.channel == "position2" and r.ratio is not None else "a declared ratio of two sensors"


NAME = Name(
    "roller_ratio",
    (SENSORS,),
    columns,
    ("encoder_eccentricity",),
    "several turns the same way: a ratio's error grows, an eccentricity comes back",
    lacks,
)
