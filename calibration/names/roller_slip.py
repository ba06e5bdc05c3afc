"""A coupling between two sensors that slips: the difference steps and stays."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.name import SENSORS, Name
from calibration.names.scene import Scene

TRIALS = 60  # places of the step that are looked at in each file


def columns(s: Scene) -> list[Candidate]:
    """A step in time, in every file on its own."""
    out = []
    for k in np.unique(s.view.file):
        mine = s.view.file == k
        t = s.view.t[mine]
        length = float(t[-1])
        for at in np.linspace(0.05, 0.95, TRIALS) * length:

            def full(p: np.ndarray, mine: np.ndarray = mine) -> np.ndarray:
                return np.where(mine, np.clip((s.view.t - p[0]) / s.view.period_s, 0.0, 1.0), 0.0)

            out.append(
                Candidate(
                    "roller_slip",
                    "time",
                    s.at(full(np.array([at])))[:, None],
                    (("step", s.unit),),
                    fixed={"time": (float(at), "s")},
                    searched=1,
                )
            )
    return out[:: max(len(out) // 120, 1)]


NAME = Name(
    "roller_slip",
    (SENSORS,),
    columns,
    ("play", "encoder_thermal_drift"),
    "out and back with gentle and hard acceleration",
)
