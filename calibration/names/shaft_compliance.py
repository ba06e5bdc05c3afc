"""A shaft that winds up with the torque it carries."""

from __future__ import annotations

from calibration.candidates.candidate import Candidate
from calibration.names.name import SENSORS, Name
from calibration.names.scene import Scene

WINDS = ("force", "effort", "current")  # columns of what winds it up, the first there is


def columns(s: Scene) -> list[Candidate]:
    """The effort, as it goes through the shaft between two sensors."""
    for channel in WINDS:
        if channel in s.view.columns:
            label = ("compliance", f"{s.unit}/{s.view.rig.columns[channel].unit}")
            return [
                Candidate("shaft_compliance", "current", s.at(s.view.columns[channel])[:, None], (label,))
            ]
    return []


def lacks(s: Scene) -> str:
    """A column of the force."""
    have = set(WINDS) & set(s.view.columns)
    return "" if have else "a column of the effort, the current or the force"


NAME = Name(
    "shaft_compliance",
    (SENSORS,),
    columns,
    ("play",),
    "lock the output and step the torque: play is a step, compliance a line",
    lacks,
)
