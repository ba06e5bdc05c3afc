"""An effort in parts of a supply that is not steady."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, VOLTS, Name
from calibration.names.scene import Scene

LEAST = 0.01  # of the mean supply: standard deviation below which it is steady


def columns(s: Scene) -> list[Candidate]:
    """The declared force times the supply's deviation: a duty must rise where the supply falls."""
    if s.volts:
        return _of_a_duty(s)
    if lacks(s):
        return []
    supply = s.view.columns["supply"]
    mean = float(supply.mean())
    model = s.problem.y - s.residual
    column = -model * s.at(supply / mean - 1.0)
    return [Candidate("supply_sag", "current", column[:, None], (("share", "1"),), sign=1, most=3.0)]


def _of_a_duty(s: Scene) -> list[Candidate]:
    """Volts that the supply's own resistance takes: the bridge draws duty times current, and gives the duty
    of what is left."""
    duty = s.view.columns.get("duty")
    if duty is None or "supply" in s.view.columns:
        return []
    column = s.at(duty**2 * s.view.columns["current"])
    return [Candidate("supply_sag", "current", column[:, None], (("resistance", "ohm"),), sign=1)]


def lacks(s: Scene) -> str:
    """A supply column that changes; of a balance of volts a duty of a supply that is not logged."""
    if s.volts:
        return "" if "duty" in s.view.columns else "a column of the duty: measured volts have sagged already"
    if s.view.response.channel != "effort" or s.view.response.divide_by == "supply":
        return "an effort that is not over the supply already"
    supply = s.view.columns.get("supply")
    if supply is None:
        return "a column of the supply"
    mean = abs(float(supply.mean())) or 1.0
    return "" if float(np.std(supply)) > LEAST * mean else "a supply that changes by more than a percent"


NAME = Name(
    "supply_sag",
    (FORCE, VOLTS),
    columns,
    ("viscous_change",),
    "record the supply voltage and divide by it, or feed the drive from a steady supply",
    lacks,
)
