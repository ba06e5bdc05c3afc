"""A torque constant that changes over the motor's angle."""

from dataclasses import replace

import numpy as np

from calibration.names.lines import beside_stage, line, motor_lines, of_stage, over_motor
from calibration.names.name import FORCE, VOLTS, Candidate, Name, Scene

MOST = 0.5  # part of the force: motors' data sheets have 0.01 to 0.1; ASSUMPTION: more is something else
HARMONICS = 12  # harmonics of a motor's stage. ASSUMPTION


def columns(s: Scene) -> list[Candidate]:
    """Sines of a motor times the force that it makes; of volts times its back-EMF."""
    if s.pair is not None:
        return [] if s.windings is not None else motor_lines(s, NAME.name, "ripple", s.pair.torque)
    if lacks(s):
        return []
    # the declared part: the response itself would bring its noise along
    load = np.interp(np.arange(len(s.view.t)), s.view.rows, s.problem.y - s.residual)
    if s.windings is not None:
        load = s.declared["torque_constant"] * s.view.rate(s.view.x)
    blank, out = line(s, NAME.name, 0.0, "ripple", most=MOST), []
    for stage in s.view.rig.stages:
        if stage.of_motor:
            few = replace(stage, harmonics=min(stage.harmonics, HARMONICS))
            out += of_stage(s, few, replace(blank, neighbours=beside_stage(s, stage)), load)
    return out


def lacks(s: Scene) -> str:
    """A force that is more than friction; volts have their back-EMF."""
    if s.windings is not None:
        return ""
    more = s.weighed or {"inertia", "stiffness"} & set(s.declared)
    if more and s.view.response.channel != "acceleration":
        return ""
    return "a force beside friction (mass or weight): else it is friction over position"


NAME = Name(
    name="torque_ripple",
    scaled=True,
    channels=(FORCE, VOLTS),
    columns=columns,
    # the motors give r cos(x + phase) more; the plant's torque constant has a cosine that is missing
    to_plant=lambda f, facts: over_motor(f, facts, "ripple", np.pi),
    experiment="hold the speed and vary the torque: ripple grows, cogging stays",
    lacks=lacks,
)
