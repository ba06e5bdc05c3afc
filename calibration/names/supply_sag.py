"""An effort in parts of a supply that is not steady."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, Name
from calibration.names.scene import Scene

LEAST = 0.01  # of the mean supply: standard deviation below which it is steady


def columns(s: Scene) -> list[Candidate]:
    """The declared force times the supply's deviation: a duty must rise where the supply falls."""
    if lacks(s):
        return []
    supply = s.view.columns["supply"]
    mean = float(supply.mean())
    model = s.problem.y - s.residual
    column = -model * s.at(supply / mean - 1.0)
    return [Candidate("supply_sag", "current", column[:, None], (("share", "1"),), sign=1, most=3.0)]


def lacks(s: Scene) -> str:
    """A supply column that changes."""
    if s.view.response.channel != "effort" or s.view.response.divide_by == "supply":
        return "an effort that is not over the supply already"
    supply = s.view.columns.get("supply")
    if supply is None:
        return "a column of the supply"
    mean = abs(float(supply.mean())) or 1.0
    return "" if float(np.std(supply)) > LEAST * mean else "a supply that changes by more than a percent"


NAME = Name(
    "supply_sag",
    (FORCE,),
    columns,
    ("viscous_change",),
    "record the supply voltage and divide by it, or feed the drive from a steady supply",
    lacks,
)
