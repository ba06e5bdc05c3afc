"""Broadband torque over time."""

from calibration.names.name import Beside, Name

NAME = Name(
    name="wind_torque",
    random=True,
    experiment="repeat the run in still air, or behind a closed slit: what blows does not come back",
    beside=Beside(leftover=True),
)
