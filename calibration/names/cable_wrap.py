"""A cable bundle about an axis: a spring over its angle with a loop of its own."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.candidates.friction import stop_operator
from calibration.names.gravity_imbalance import LEAST_TURN
from calibration.names.name import FORCE, Name
from calibration.names.scene import Scene
from calibration.readers.run import Array

TRAVELS = (0.002, 0.005, 0.01, 0.02, 0.04)  # of a turn, in which the loop closes, as on the telescope's axis


def columns(s: Scene) -> list[Candidate]:
    """Stiffness over the angle, and a loop that closes within some travel."""
    if lacks(s):
        return []
    v, turn = s.view, s.view.turn or 1.0
    spring = v.x - float(np.mean(v.x[v.ok]))

    def full(p: Array) -> Array:
        travel = max(float(p[0]), 1e-4 * turn)
        return np.column_stack([spring, stop_operator(v.x, v.file, travel) / travel])

    shape = s.shaped(full)
    return [
        Candidate(
            "cable_wrap",
            "axis_angle",
            shape(np.array([part * turn])),
            (("stiffness", f"{s.unit}/{s.angle_unit}"), ("loop", s.unit)),
            fixed={"loop_travel": (part * turn, s.angle_unit)},
            shape=shape,
            steps=(0.1 * part * turn,),
            positive=(0, 1),
            searched=1,
        )
        for part in TRAVELS
        if v.resolved < part * turn < s.span
    ]


def lacks(s: Scene) -> str:
    """An angle, enough of it, and both ways."""
    if not s.view.turn:
        return "an angle: give position in rad, deg or turns, or 'turn' (position units per turn)"
    if s.span < LEAST_TURN * s.view.turn:
        return f"a motion over at least {LEAST_TURN:.2g} turns"
    return "" if s.both else "motion in both directions over the same place"


NAME = Name(
    "cable_wrap",
    (FORCE,),
    columns,
    ("gravity_imbalance",),
    "a full turn both ways: a cable pulls back more the further it is wound, a weight comes round again",
    lacks,
)
