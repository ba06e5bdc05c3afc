"""One column that is late against the others."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, SENSORS, Name
from calibration.names.scene import Scene


def columns(s: Scene) -> list[Candidate]:
    """The rate of change of the column: a late one falls behind by its rate times the delay."""
    v = s.view
    if s.force:
        if not v.dynamic or v.response.channel == "acceleration":
            return []
        # of the declared force along the motion, whose noise is smaller than the response's own
        model = s.problem.y - s.residual
        full = np.interp(np.arange(len(v.t)), v.rows, model)
        rate = v.rate(full)[v.rows]
        return [Candidate("channel_delay", "clock", -rate[:, None], (("delay", "s"),))]
    return [Candidate("channel_delay", "clock", s.at(-v.rate(v.x))[:, None], (("delay", "s"),))]


def lacks(s: Scene) -> str:
    """Accelerations, or speeds of more than one size."""
    if s.force:
        return "" if s.view.dynamic else "a balance with accelerations ('inertia')"
    return ""


NAME = Name(
    "channel_delay",
    (FORCE, SENSORS),
    columns,
    ("structural_mode", "shaft_compliance"),
    "one quick step, and compare the columns row by row",
    lacks,
)
