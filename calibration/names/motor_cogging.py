"""Torque over the motor's angle that needs no current."""

from math import pi

import numpy as np

from calibration.names.lines import motor_lines, over_motor, stage_lines
from calibration.names.name import FORCE, SPEED, Candidate, Name, Scene
from calibration.names.torque_ripple import NAME as RIPPLE


def columns(s: Scene) -> list[Candidate]:
    """Sines at the harmonics of the stages that are declared as a motor's.

    Where no load tells them from ripple, the stages declared to ripple have them, too. A pair of motors has
    them at every small order of either.
    """
    if s.pair is None:
        same = stage_lines(s, NAME.name, of=RIPPLE.name) if RIPPLE.lacks(s) else []
        return [*stage_lines(s, NAME.name), *same]
    ratio = np.full(len(s.problem.y), s.pair.train.ratio)
    return motor_lines(s, NAME.name, ("amplitude", "N m at the motor"), (ratio, ratio))


NAME = Name(
    name="motor_cogging",
    channels=(FORCE, SPEED),
    columns=columns,
    # the motors give A cos(x + phase) more; the plant has the sine that the axis gets
    to_plant=lambda f, facts: over_motor(f, facts, "amplitude", -pi / 2),
    experiment="hold the speed and vary the torque: ripple grows, cogging stays",
)
