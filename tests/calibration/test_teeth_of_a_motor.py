"""A motor's pinion has 27 teeth: a line of that order is the mesh's when encoders show it."""

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.finding import Finding
from calibration.look.torque import _of_a_gear
from plant.gears import ORDERS

MESH = ORDERS["motor"] * 27


def line(name: str, order: float) -> Candidate:
    return Candidate(name, "motor_angle", np.zeros((4, 2)), (("amplitude", "N m"),), order=order)


@pytest.mark.parametrize("name", ["torque_ripple", "motor_cogging"])
def test_a_motors_line_is_not_offered_at_the_order_of_a_mesh_that_encoders_show(name: str) -> None:
    assert pytest.approx(ORDERS["mesh1"]) == MESH
    shown = [Finding("gear_mesh", "K", "axis_angle", stage="mesh1", harmonic=1, order=ORDERS["mesh1"])]
    assert _of_a_gear(line(name, MESH), shown)
    assert not _of_a_gear(line(name, ORDERS["motor"] * 6), shown)
    assert not _of_a_gear(line("gear_mesh", MESH), shown)
    assert not _of_a_gear(line(name, MESH), [])
