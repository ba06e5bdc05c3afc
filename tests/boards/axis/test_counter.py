"""The counter torque's register: when it moves, and that the effort does not mind."""

from itertools import pairwise

import pytest

from boards.axis.pi import CounterTorque
from bus.protocol import Opcode, Result
from bus.protocol.scales import rate_q16
from tests.boards.lab import Lab, axis_config
from tests.boards.rigid import RigidAxis


class Blocked(RigidAxis):
    """It does not move, so that the effort creeps as the loop's integral alone."""

    def advance(self, t_ns: int) -> None:
        self.t_ns = t_ns


@pytest.mark.parametrize("split", [10, 17, 25])
@pytest.mark.parametrize("sign", [1, -1])
def test_B2_the_register_waits_until_it_is_a_whole_step_off(split: int, sign: int) -> None:
    """Up and down again in single steps: it is never a step off; an effort that trembles does not move it."""
    counter = CounterTorque(split, 0)
    for effort in [*range(400), *range(400, 100, -1)]:
        counter.follow(sign * effort, 0)
        assert abs(counter.register * 100 - effort * split) < 100
        before = counter.register
        for near in (1, 0, -1):
            counter.follow(sign * (effort + near), 0)
        if abs(before * 100 - effort * split) < 100 - split:
            assert counter.register == before


@pytest.mark.parametrize(("effort", "register"), [(24, 2), (26, 3), (-24, 2), (-26, 3), (3000, 300)])
def test_B2_a_jump_takes_the_register_to_the_nearest_step(effort: int, register: int) -> None:
    counter = CounterTorque(10, 0)
    counter.follow(effort, 0)
    assert counter.register == register


@pytest.mark.parametrize("sign", [1, -1])
def test_B2_the_effort_goes_on_evenly_when_the_register_moves(
    sign: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Below the drop of a diode the lagging motor conducts nothing: there a step more would be a bump."""
    monkeypatch.setattr("tests.boards.lab.RigidAxis", Blocked)
    lab = Lab(axis_config(counter_split=10))
    lab.run(0.1)
    assert lab.command(Opcode.POWER, 1).result == Result.OK
    lab.command(Opcode.SET_RATE, sign * rate_q16(15.0))
    lab.run(1.0)
    leads, lags = [], []
    for _ in range(500):
        lab.run(0.005)
        duties = lab.axis.pwm.pdc_a, lab.axis.pwm.pdc_b
        leads.append(duties[0 if sign > 0 else 1])
        lags.append(duties[1 if sign > 0 else 0])
    rises = [k for k, (before, after) in enumerate(pairwise(leads)) if after != before]
    assert {leads[k + 1] - leads[k] for k in rises} == {1}
    assert lags[-1] - lags[0] >= 6
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
    counter.follow(3000, 1500)
    assert counter.register == 0


@pytest.mark.parametrize(("effort", "velocity"), [(1000, 0), (2000, 500), (2000, -500)])
def test_B2_the_finer_share_falls_alike(effort: int, velocity: int) -> None:
    """10 % of 1000, or of half of 2000 at half the speed; smoothed, a step moves it 1/32 of the way."""
    counter = CounterTorque(10, 1000)
    assert counter.share_q16(effort << 16, velocity) == (100 << 16) // 32
    assert counter.share_q16(effort << 16, 1000) == ((100 << 16) // 32) * 31 // 32


def test_B2_without_effort_before_there_is_no_share() -> None:
    counter = CounterTorque(10, 0)
    counter.follow(5, 0)  # half a step
    assert counter.register == 0
    assert counter.share_q16(330, 0) == 1  # 33 / 32
