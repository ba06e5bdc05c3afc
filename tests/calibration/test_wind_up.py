"""What an ampere winds a train up by comes from the encoders: the declared stiffness may be another."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calibration.balances.frame import build_frame
from calibration.balances.kinematic import wind_up
from calibration.balances.motion import motion_of
from calibration.balances.torque import WIDTH
from calibration.inputs.axislog import read_axis_log
from calibration.inputs.declaredplant import declared_numbers
from plant.loop import Excitation, simulate
from plant.model import PlantModel, load
from tests.calibration.logs import manoeuvre, write_log


def softer(model: PlantModel, times: float) -> PlantModel:
    """The plant with another stiffness of its RA trains."""
    gear = model.axes.ra.gear
    gear = replace(gear, stiffness=replace(gear.stiffness, value=times * gear.stiffness.value))
    return replace(model, axes=replace(model.axes, ra=replace(model.axes.ra, gear=gear)))


@pytest.mark.parametrize("times", [0.5, 1.0, 2.0])
def test_the_encoders_tell_it(tmp_path: Path, times: float) -> None:
    model = softer(load("low_preload"), times)
    wanted = manoeuvre("ramp")
    log = simulate(model, "ra", len(wanted) * 0.01, Excitation(setpoint=wanted, start_steps=3e8), seed=4)
    path = tmp_path / "run1.log"
    write_log(path, log)
    runs = [read_axis_log(path, path.read_text(encoding="utf-8"))]
    frame = build_frame(runs)
    found = wind_up(
        frame, motion_of(frame, WIDTH), np.zeros(len(frame.t), dtype=bool), declared_numbers(runs, None)
    )
    axis = model.axes.ra
    train = axis.gear.stiffness.si / 2  # the plant file's is both trains'
    truth = axis.motor.torque_constant.si * frame.scale["gear_ratio"] / train
    assert found == pytest.approx(truth, rel=0.1)
