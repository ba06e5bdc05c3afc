"""A torque constant that changes over the motor's angle."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, VOLTS, Name
from calibration.names.scene import Scene
from calibration.names.sines import over_place, stage_lines
from calibration.readers.run import Array

MOST = 0.5  # of the force: motors' data sheets have 0.01 to 0.1; ASSUMPTION: more is something else


def columns(s: Scene) -> list[Candidate]:
    """Sines of a motor stage times the force that the motor makes."""
    if lacks(s):
        return []
    # the declared part: the response itself would bring its noise along. Of volts it is the back-EMF
    load = _emf(s) if s.volts else np.interp(np.arange(len(s.view.t)), s.view.rows, s.problem.y - s.residual)
    stages = {g.name: g for g in s.view.rig.stages}
    out = []
    for c in [*stage_lines(s, "torque_ripple"), *stage_lines(s, "motor_cogging")]:
        stage = stages[str(c.stage)]
        if not stage.period or c.harmonic is None or c.harmonic > 12:
            continue
        if c.per_run:
            continue  # over_place makes both
        blank = replace(c, name="torque_ripple", labels=(("ripple", "1"),), most=MOST)
        out += over_place(s, blank, c.harmonic / stage.period, load)
    return out


def _emf(s: Scene) -> Array:
    return s.declared["torque_constant"] * s.view.rate(s.view.x)


def lacks(s: Scene) -> str:
    """A force that is more than friction; volts have their back-EMF."""
    if s.volts:
        return ""
    more = {"inertia", "gravity_cos", "stiffness"} & set(s.declared)
    if more and s.view.response.channel != "acceleration":
        return ""
    return "a force beside friction (mass or weight): else it is friction over position"


NAME = Name(
    "torque_ripple",
    (FORCE, VOLTS),
    columns,
    ("motor_cogging",),
    "hold the speed and vary the torque: ripple grows, cogging stays",
    lacks,
)
