"""A gear, shaft or screw that runs out of true."""

from math import pi

from calibration.inputs.train import SHAFT
from calibration.names.lines import stage_lines
from calibration.names.name import FORCE, SENSORS, SPEED, Facts, Finding, Made, Name, value
from plant.gears import ORDERS

TURN = pi / 2  # rad, from a cosine to the sine of a plant file
#: mesh -> shaft that carries one of its wheels
SHAFT_OF_MESH = {"mesh1": "motor", "mesh2": "shaft1", "mesh3": "shaft2"}


def to_plant(f: Finding, facts: Facts) -> Made:
    """Torque of channel T, whose A cos(x + phase) the motors must add, the axis has less; twist of K."""
    made = Made()
    stage, harmonic = f.stage or "axis", f.harmonic or 1
    if f.channel == "K":
        twist(made, facts, stage, harmonic, value(f, "amplitude"), value(f, "phase"))
        return made
    values = {"amplitude": value(f, "amplitude"), "phase": value(f, "phase") - TURN}
    made.add(f.name, facts, values, stage, harmonic)
    found = facts.twists.get((stage, harmonic))
    if found is not None:
        twist(made, facts, stage, harmonic, *found)
    elif "kinematic" in f.parameters:
        one = "its twist shows in one train, the plant's acts on both: left out"
        made.remarks.append(f"{f.name} on {stage}: {one}")
    return made


def twist(made: Made, facts: Facts, stage: str, harmonic: int, arcsec: float, phase: float) -> None:
    """Add what a stage twists the trains by; a mesh's is a harmonic of the shaft that carries its wheel."""
    if stage in SHAFT_OF_MESH:
        shaft = SHAFT_OF_MESH[stage]
        teeth = round(ORDERS[stage] / ORDERS[shaft])
        made.remarks.append(f"the twist at {stage} is written as harmonic {teeth * harmonic} of {shaft}")
        stage, harmonic = shaft, teeth * harmonic
    made.add(SHAFT, facts, {"kinematic": arcsec, "phase": phase - TURN}, stage, harmonic)


NAME = Name(
    name=SHAFT,
    channels=(FORCE, SENSORS, SPEED),
    columns=lambda s: stage_lines(s, SHAFT, default=s.force),  # of every stage without another kind
    experiment="a second speed: a gear keeps its angle, a resonance its frequency, more travel splits "
    "close orders",
    to_plant=to_plant,
)
