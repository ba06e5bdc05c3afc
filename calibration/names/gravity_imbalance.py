"""A weight that hangs off the axis."""

from __future__ import annotations

from math import pi

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, Name
from calibration.names.scene import Scene
from plant.effects.signals import ANGLE

LEAST_TURN = 1 / 12  # of travel: on less, a sine is a slope and an offset


def gravity(s: Scene) -> np.ndarray:
    """cos and sin of the angle (n_full, 2): the effect's own formula at phases 0 and 90 degrees."""
    angle = s.view.x / (s.view.turn or 1.0) * 2 * pi
    one = {"amplitude": 1.0, "phase": 0.0}
    parts = [s.formula("gravity_imbalance", {ANGLE: angle}, {**one, "phase": p}) for p in (0.0, pi / 2)]
    return np.column_stack(parts)


def columns(s: Scene) -> list[Candidate]:
    """One sine per turn, its phase fixed to the place: sessions share it when they share the zero."""
    if lacks(s) or "gravity_cos" in s.declared:
        return []
    return [
        Candidate(
            "gravity_imbalance",
            "axis_angle",
            s.at(gravity(s)),
            (("amplitude", s.unit),),
            kind="line",
            stage="axis",
            harmonic=1,
            order=1.0,
            twins=("gear_eccentricity",) if any(_once_per_turn(s)) else (),
        )
    ]


def _once_per_turn(s: Scene) -> list[bool]:
    """For every declared stage, whether it turns with the weight."""
    turn = s.view.turn or 1.0
    return [bool(g.period) and abs(float(g.period or 0.0) / turn - 1) < 1e-6 for g in s.view.rig.stages]


def lacks(s: Scene) -> str:
    """An angle, and enough of it."""
    if not s.view.turn:
        return "an angle: give position in rad, deg or turns, or 'turn' (position units per turn)"
    if s.span < LEAST_TURN * s.view.turn:
        return f"a motion over at least {LEAST_TURN:.2g} turns"
    return ""


NAME = Name(
    "gravity_imbalance",
    (FORCE,),
    columns,
    ("cable_wrap", "gear_eccentricity"),
    "move through at least 60 degrees slowly, there and back; another weight changes it, a spring stays",
    lacks,
)
