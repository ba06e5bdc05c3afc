"""A current that reads too much: torque is made of what the motor draws, and torques are as sure as that."""

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.look.volts import reading_error, weakened
from calibration.names.scene import MOTOR

CLOCK = np.arange(5.0)


def gain(motor: float) -> Candidate:
    return Candidate(
        "adc_gain", "current", np.zeros((4, 1)), (("gain", "1"),), fixed={"motor": (motor, MOTOR)}
    )


@pytest.mark.parametrize(("motor", "key", "other"), [(1.0, "a", "b"), (2.0, "b", "a")])
def test_a_gain_that_volts_show_is_undone_in_the_torque(motor: float, key: str, other: str) -> None:
    left = weakened([(gain(motor), np.array([0.02]))], CLOCK)
    assert left[key] == pytest.approx(np.full(5, 0.98))
    assert left[other] == pytest.approx(np.ones(5))


def test_which_reading_is_right_is_half_known() -> None:
    assert reading_error([]) == 0.0
    assert reading_error([(gain(1.0), np.array([-0.02]))]) == pytest.approx(0.01)
