"""A position on its way: latched, aged on the encoder board, sent, and carried on at the velocity of now."""

import pytest

from boards.axis.motion import Motion
from boards.axis.pi import IncrementalPi
from boards.axis.profile import UNITS_PER_STEP
from boards.axis.tachometer import RemoteTachometer
from bus.protocol import pack_position
from bus.protocol.motion import pack_tach
from bus.protocol.scales import rate_q16
from tests.boards.lab import axis_config

FRAME_NS, TICK_NS = 120_000, 5_000_000
COUNT = 1 << 18  # units of a count
ROUNDED = 0.5 / 54_975  # counts per tick and ns, Q38, is a whole number near 2^38 / 5e6


def told(age: int, now_ns: int = 0, position: int = 5_000_000) -> Motion:
    """A board that takes a frame of this age, in units of 4 µs, at `now_ns`."""
    found = Motion(axis_config(frame_ns=FRAME_NS), IncrementalPi(0, 0, 3000))
    found.take_position(now_ns, pack_position(0x21, 0, position, age, 1))
    return found


@pytest.mark.parametrize(("age", "later_ns", "velocity"), [
    (0, 0, 1000), (250, 0, 1000), (250, 3_880_000, 1000), (70, 1_000_000, -3136), (250, 9_000_000, 7),
])  # fmt: skip
def test_B2_a_position_is_carried_on_by_its_whole_age(age: int, later_ns: int, velocity: int) -> None:
    since_ns = age * 4000 + FRAME_NS + later_ns
    gone = velocity * since_ns / TICK_NS
    found = told(age).measured(later_ns, velocity) - 5_000_000 * UNITS_PER_STEP
    assert found / COUNT == pytest.approx(gone, rel=ROUNDED, abs=1e-3)


def test_B2_a_position_is_carried_on_for_a_tenth_of_a_second_and_no_further() -> None:
    """By `measured` as by the position loop, which has the same written out: both wait at 20 ticks."""
    for later_ns in (99_880_000, 400_000_000):
        found = told(0).measured(later_ns, 1000) - 5_000_000 * UNITS_PER_STEP
        assert found / COUNT == pytest.approx(20_000.0, rel=ROUNDED)
    setpoints = []
    for later_ns in (99_880_000, 400_000_000):
        axis = told(0)
        axis.move(0, 0, 5_000_000, rate_q16(100.0))
        setpoints.append(axis.setpoint(later_ns, 1))
    assert setpoints[0] == setpoints[1] < 0  # it thinks it has gone 20 counts too far


def test_B4_a_motor_board_that_falls_silent_is_not_carried_on() -> None:
    """100 counts a frame; two frames missed, 25 ms, and the sample is zero instead of a guess."""
    tachometer = RemoteTachometer(FRAME_NS)
    for frame in range(40):
        tachometer.take(frame * 10_000_000, pack_tach(0x31, 0, frame * 100, 100))
        tachometer.sample(frame * 10_000_000 + 1_000_000)
    last_ns = 390_000_000 - FRAME_NS - 40_000  # latched before the frame was made and sent
    assert tachometer.sample(last_ns + 11_000_000) == pytest.approx(100, abs=2)
    assert tachometer.sample(last_ns + 25_100_000) == 0
