"""A sensor that moves with the temperature."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.name import SENSORS, Name
from calibration.names.scene import Scene

LEAST_K = 0.5  # of change before a coefficient means anything


def columns(s: Scene) -> list[Candidate]:
    """The temperature less its mean."""
    if lacks(s):
        return []
    t = s.view.columns["temperature"]
    label = ("drift", f"{s.unit}/K")
    return [Candidate("encoder_thermal_drift", "temperature", s.at(t - t.mean())[:, None], (label,))]


def lacks(s: Scene) -> str:
    """A temperature that changes."""
    t = s.view.columns.get("temperature")
    if t is None:
        return "a temperature column"
    return "" if float(np.ptp(t)) > LEAST_K else f"a temperature that changes by more than {LEAST_K} K"


NAME = Name(
    "encoder_thermal_drift",
    (SENSORS,),
    columns,
    ("roller_slip",),
    "the same motion warm and cold",
    lacks,
)
