"""Teeth that mesh unevenly."""

from calibration.inputs.train import MESH
from calibration.names.gear_eccentricity import to_plant
from calibration.names.lines import stage_lines
from calibration.names.name import FORCE, SENSORS, SPEED, Name

NAME = Name(
    name=MESH,
    channels=(FORCE, SENSORS, SPEED),
    columns=lambda s: stage_lines(s, MESH),
    experiment="a second speed, and travel enough to split it from the neighbouring order",
    to_plant=to_plant,
)
