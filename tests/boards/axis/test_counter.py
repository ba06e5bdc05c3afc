"""The counter torque's register: no step of the effort is lost to it."""

from itertools import pairwise

import pytest

from boards.axis.counter import CounterTorque
from boards.axis.pi import IncrementalPi


@pytest.mark.parametrize("split", [10, 17, 25])
@pytest.mark.parametrize("sign", [1, -1])
def test_B2_every_step_of_a_loops_effort_is_a_step_of_torque(split: int, sign: int) -> None:
    """Up and down again in single steps: leading less lagging register moves by one each time."""
    pi, counter, nets = IncrementalPi(0, 1 << 12, 3000), CounterTorque(split, 0), []
    for error in [sign] * 400 + [-sign] * 300:
        effort = pi.step(error << 16, 0)
        moved = counter.follow(effort, 0)
        if moved:
            assert abs(moved) == 1
            effort += pi.shift(moved)
        nets.append(abs(effort) - counter.register)
    assert {abs(after - before) for before, after in pairwise(nets)} == {1}


def test_B2_motors_off_are_both_off() -> None:
    counter = CounterTorque(10, 0)
    counter.follow(14, 0)
    assert counter.register == 1
    counter.follow(0, 0)
    assert counter.register == 0


def test_B2_the_share_falls_with_speed_when_told_to() -> None:
    counter = CounterTorque(20, 1000)
    counter.follow(1000, 500)
    assert counter.register == 100
    counter.follow(1000, -1000)
    assert counter.register == 0
