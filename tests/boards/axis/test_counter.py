"""The counter torque's register: no step of the effort is lost to it."""

from itertools import pairwise

import pytest

from boards.axis import AxisConfig
from boards.axis.counter import CounterTorque
from boards.axis.pi import IncrementalPi
from bus.protocol import Opcode, Result
from bus.protocol.scales import rate_q16
from tests.boards.lab import Lab
from tests.boards.rigid import RigidAxis


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


class Blocked(RigidAxis):
    """It does not move, so that the effort creeps as the loop's integral alone."""

    def advance(self, t_ns: int) -> None:
        self.t_ns = t_ns


@pytest.mark.parametrize("sign", [1, -1])
def test_B2_the_board_moves_its_register_without_a_bump(sign: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The duties' difference rises by one each time, at even intervals, past six moves of the register."""
    monkeypatch.setattr("tests.boards.lab.RigidAxis", Blocked)
    lab = Lab(AxisConfig(counter_split=10))
    lab.run(0.1)
    assert lab.command(Opcode.POWER, 1).result == Result.OK
    lab.command(Opcode.SET_RATE, sign * rate_q16(15.0))
    lab.run(1.0)
    nets = []
    for _ in range(500):
        lab.run(0.005)
        nets.append(sign * (lab.axis.pwm.pdc_a - lab.axis.pwm.pdc_b))
    rises = [k for k, (before, after) in enumerate(pairwise(nets)) if after != before]
    assert {nets[k + 1] - nets[k] for k in rises} == {1}
    assert nets[-1] - nets[0] >= 60
    gaps = [after - before for before, after in pairwise(rises)]
    assert max(gaps) - min(gaps) <= 1, gaps


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
