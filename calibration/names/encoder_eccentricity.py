"""A sensor's disc that runs out of true."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.name import SENSORS, Name
from calibration.names.scene import Scene
from calibration.names.sines import over_place, stage_lines


def columns(s: Scene) -> list[Candidate]:
    """Sines at the stages without another kind; without a stage of that length, at one turn of the
    position."""
    out = stage_lines(s, "encoder_eccentricity", default=True)
    turn = s.view.turn
    have = [c.order for c in out]
    if turn and s.span > 0.4 * turn:
        for h in (1, 2):
            if not any(o is not None and abs(o - h) < 1e-6 for o in have):
                one = Candidate(
                    "encoder_eccentricity",
                    "axis_angle",
                    np.zeros((len(s.view.rows), 0)),
                    (("amplitude", s.unit),),
                    kind="line",
                    stage="axis",
                    harmonic=h,
                    order=float(h),
                )
                out += over_place(s, one, h / turn)
    return [replace(c, twins=("gear_eccentricity",)) for c in out]


NAME = Name(
    "encoder_eccentricity",
    (SENSORS,),
    columns,
    ("gear_eccentricity",),
    "turn one sensor's disc against its shaft: the error turns with it, a gear's does not",
)
