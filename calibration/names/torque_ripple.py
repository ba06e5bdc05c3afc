"""A torque constant that changes over the motor's angle."""

from __future__ import annotations

from dataclasses import replace

from calibration.candidates.candidate import Candidate, sine_columns
from calibration.names.name import FORCE, Name
from calibration.names.scene import Scene
from calibration.names.sines import stage_lines


def columns(s: Scene) -> list[Candidate]:
    """Sines of a motor stage times the force that the motor makes."""
    if lacks(s):
        return []
    load = s.problem.y - s.residual  # the declared part: the response itself would bring its noise along
    x = s.view.x[s.view.rows]
    stages = {g.name: g for g in s.view.rig.stages}
    out = []
    for c in [*stage_lines(s, "torque_ripple"), *stage_lines(s, "motor_cogging")]:
        stage = stages[str(c.stage)]
        if not stage.period or c.harmonic is None or c.harmonic > 12:
            continue
        rate = c.harmonic / stage.period
        columns = sine_columns(x * rate, s.session, load)
        out.append(replace(c, name="torque_ripple", columns=columns, labels=(("ripple", "1"),)))
    return out


def lacks(s: Scene) -> str:
    """A force that is more than friction."""
    more = {"inertia", "gravity_cos", "stiffness"} & set(s.declared)
    if more and s.view.response.channel != "acceleration":
        return ""
    return "a force beside friction (mass or weight): else it is friction over position"


NAME = Name(
    "torque_ripple",
    (FORCE,),
    columns,
    ("motor_cogging",),
    "hold the speed and vary the torque: ripple grows, cogging stays",
    lacks,
)
