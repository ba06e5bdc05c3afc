"""What a mode leaves to the next, when an axis has settled, which gains are in force: frames by hand."""

import pytest

from boards.axis.config import steps
from boards.axis.hold import RateLock
from boards.axis.motion import Motion
from boards.axis.pi import IncrementalPi
from boards.axis.profile import UNITS_PER_STEP
from bus.protocol import AxisMode, PositionFlag, pack_position
from bus.protocol.scales import rate_q16
from tests.boards.lab import axis_config

PLACE = 200_000_000
CONFIG = axis_config(
    kp=1.0, ki=0.01, kp_pointing=2.0, ki_pointing=0.02, ki_creep=0.03, kp_gust=4.0, ki_gust=0.04,
)  # fmt: skip
PLAIN, STOPPING, CREEPING, WINDY, LOCKED = ((1.0, 0.01), (2.0, 0.02), (2.0, 0.03), (4.0, 0.04), (2.0, 0.03))
FRAME_NS = CONFIG.frame_ns


class Axis:
    """A board's motion, seen by an encoder that stands unless it is told."""

    def __init__(self) -> None:
        self.pi = IncrementalPi(round(CONFIG.kp * 4096), round(CONFIG.ki * 4096), 3000)
        self.motion = Motion(CONFIG, self.pi)
        self.at(PLACE)

    def at(self, position: int, flags: int = 0, age: int = 0) -> None:
        self.motion.take_position(FRAME_NS, pack_position(0x21, flags, position, age, 1))

    def run(self, ticks: int, velocity: int = 0) -> int:
        found = 0
        for _ in range(ticks):
            found = self.motion.setpoint(0, velocity)
        return found

    @property
    def gains(self) -> tuple[float, float]:
        return round(self.pi.kp_q12 / 4096, 3), round(self.pi.ki_q12 / 4096, 3)


def test_B1_an_axis_without_power_asks_for_nothing() -> None:
    axis = Motion(CONFIG, IncrementalPi(0, 0, 3000))
    assert (axis.setpoint(0, 1000), axis.setpoint_q16, axis.steady) == (0, 0, (0, 0))
    assert (axis.mode, axis.selected, axis.position, axis.ends) == (AxisMode.OFF, 0, 0, 0)
    assert not axis.settled and axis.distance_steps(0, 0) == 0


def test_B9_a_position_is_fresh_until_ten_frames_are_missing() -> None:
    axis = Motion(CONFIG, IncrementalPi(0, 0, 3000))
    assert not axis.fresh(0)
    axis.take_position(7, pack_position(0x21, 0, PLACE, 0, 1))
    assert axis.fresh(7 + 49_999_999) and not axis.fresh(7 + 50_000_000)
    axis.forget()
    assert not axis.fresh(7)


def test_B3_a_position_has_29_bits_and_the_limits_flags() -> None:
    axis = Axis()
    data = bytes((0x21, 0xFF & ~PositionFlag.ALARM & ~PositionFlag.CRC_ERROR, 0x78, 0x56, 0x34, 0xF2, 0, 1))
    axis.motion.take_position(0, data)
    assert axis.motion.position == 0x12345678
    assert axis.motion.ends == PositionFlag.LIMIT_LOW | PositionFlag.LIMIT_HIGH


@pytest.mark.parametrize("rate", [0, rate_q16(0.1)])
@pytest.mark.parametrize(("off", "settles"), [(2070, True), (-2070, True), (2071, False), (-2071, False)])
def test_B2_settled_is_half_a_second_within_5_arcsec(off: int, settles: bool, rate: int) -> None:
    """They are 2071 steps of 2^29 a turn, it is 100 ticks. With a rate the mode is TRACK from the first of
    them, without it stays MOVE."""
    axis = Axis()
    axis.motion.move(0, 0, PLACE, rate_q16(7200.0))
    axis.at(PLACE - off)
    axis.run(99)
    assert not axis.motion.settled and axis.motion.mode is AxisMode.MOVE
    axis.run(1)
    assert axis.motion.settled is settles
    assert axis.motion.distance_steps(0, 0) == off
    if rate:
        axis.motion.track(0, 0, rate if off > 0 else -rate)
        axis.run(1)
        assert axis.motion.mode is (AxisMode.TRACK if settles else AxisMode.MOVE)
    axis.at(PLACE - steps(6.0))
    axis.run(1)
    assert not axis.motion.settled
    axis.at(axis.motion.target_steps)
    axis.run(99)
    assert not axis.motion.settled  # all over again


def test_B2_an_axis_that_passes_its_target_has_not_settled() -> None:
    """Right under it the whole move, with the reference still on its way."""
    axis = Axis()
    axis.motion.move(0, 0, PLACE + steps(3600.0), rate_q16(100.0))
    for _ in range(300):
        axis.run(1)
        profile = axis.motion.profile
        axis.at((profile.target - profile.remaining) // UNITS_PER_STEP)
    assert not axis.motion.settled and axis.motion.profile.remaining


def test_B2_who_leaves_the_position_loop_is_settled_no_more() -> None:
    axis = Axis()
    axis.motion.move(0, 0, PLACE, rate_q16(7200.0))
    axis.run(200)
    assert axis.motion.settled
    axis.motion.run(AxisMode.RATE, 0)
    assert not axis.motion.settled and axis.motion.distance_steps(0, 0) == 0
    axis.motion.move(0, 0, PLACE, rate_q16(7200.0))
    axis.run(1)
    assert not axis.motion.settled


@pytest.mark.parametrize("leave", ["open loop", "rate", "off"])
def test_B2_a_rate_of_before_does_not_move_the_next_target(leave: str) -> None:
    axis = Axis()
    axis.motion.track(0, 0, rate_q16(15.0))
    axis.run(10)
    assert axis.motion.steady[0] == pytest.approx(rate_q16(15.0), rel=0.01)
    if leave == "open loop":
        axis.motion.open_loop()
        assert axis.run(1, velocity=37) == axis.motion.setpoint_q16 == 37 << 16
    elif leave == "rate":
        axis.motion.run(AxisMode.RATE, 0)
        axis.run(1)
    else:
        axis.motion.off()
    assert axis.motion.steady == (0, 0)
    axis.motion.move(0, 0, PLACE, rate_q16(600.0))
    axis.run(100)
    assert axis.motion.target_steps == PLACE
    assert axis.motion.steady[0] == 0
    axis.motion.track(0, 0, rate_q16(15.0))
    axis.run(200)
    assert axis.motion.target_steps == pytest.approx(PLACE + steps(15.0), abs=1)  # a second later


@pytest.mark.parametrize("sign", [1, -1])
def test_B1_the_set_point_of_a_rate_is_a_ramp_to_it(sign: int) -> None:
    """36 arcsec/s in a tick (Table 1: 2 deg/s2): 100 arcsec/s in the third."""
    axis = Axis()
    axis.motion.run(AxisMode.RATE, sign * rate_q16(100.0))
    found = [axis.run(1) for _ in range(4)]
    assert found == pytest.approx([sign * rate_q16(each) for each in (36.0, 72.0, 100.0, 100.0)], abs=2)
    assert axis.motion.steady == (sign * rate_q16(100.0), 0)
    axis.motion.run(AxisMode.STOP, 0)
    axis.run(1)
    assert axis.motion.steady == (0, 0)  # nothing is to be held while it brakes


@pytest.mark.parametrize(
    ("moved_arcsec_s", "relative_arcsec_s"), [(15.0, 100.0), (600.0, 600.0), (None, 600.0)]
)
def test_B2_a_nudge_goes_at_guiding_speed_or_faster(
    moved_arcsec_s: float | None, relative_arcsec_s: float
) -> None:
    """At the speed of the move before; of a track from rest: that of the class "set", 600 arcsec/s."""
    axis = Axis()
    if moved_arcsec_s:
        axis.motion.move(0, 0, PLACE, rate_q16(moved_arcsec_s))
    axis.motion.track(0, 0, 0)
    axis.run(1)
    axis.motion.nudge(steps(36_000.0))
    assert axis.motion.mode is AxisMode.MOVE
    fastest = 0
    for _ in range(100):
        profile = axis.motion.profile
        axis.at((profile.target - profile.remaining) // UNITS_PER_STEP)
        axis.run(1)
        fastest = max(fastest, axis.motion.steady[0])
    assert fastest == pytest.approx(rate_q16(relative_arcsec_s), rel=1e-3)


def test_B2_the_position_loop_begins_at_the_speed_in_force() -> None:
    axis = Axis()
    axis.motion.run(AxisMode.RATE, rate_q16(600.0))
    before = axis.run(20)
    axis.motion.track(0, 0, rate_q16(15.0))
    axis.run(1)
    assert axis.motion.steady[0] == pytest.approx(before, abs=rate_q16(36.0))


def test_B1_gains_by_mode() -> None:
    axis = Axis()
    axis.motion.run(AxisMode.RATE, 0)
    assert axis.gains == PLAIN
    axis.motion.run(AxisMode.STOP, 0)
    assert axis.gains == STOPPING
    axis.motion.set_gains(round(0.5 * 4096), round(0.25 * 4096))
    assert axis.gains == STOPPING
    axis.motion.run(AxisMode.CLASS, 0)
    assert axis.gains == (0.5, 0.25)
    axis.motion.track(0, 0, 0)
    axis.run(1)
    assert axis.gains == CREEPING
    for rate, gains in ((rate_q16(200.0) - 1, CREEPING), (rate_q16(200.0), STOPPING)):
        axis.motion.track(0, 0, rate)
        axis.run(20)
        assert axis.gains == gains


@pytest.mark.parametrize(("arcsec_s", "moves", "noticed"), [
    (0.0, False, True), (100.0, False, True), (250.0, False, False), (100.0, True, False),
])  # fmt: skip
def test_B1_wind_is_sought_where_the_axis_creeps_and_has_arrived(
    arcsec_s: float, moves: bool, noticed: bool
) -> None:
    """3 Hz of 3 counts a tick either way, with the absolute encoder right on the reference."""
    axis = Axis()
    axis.motion.set_lock(1)
    if moves:
        axis.motion.move(0, 0, PLACE + steps(36_000.0), rate_q16(arcsec_s))
    else:
        axis.motion.track(0, 0, rate_q16(arcsec_s))
    for k in range(2200):
        profile = axis.motion.profile
        axis.at((profile.target - profile.remaining) // UNITS_PER_STEP)
        axis.run(1, velocity=round(arcsec_s * 0.43556) + (3 if k // 33 % 2 else -3))
    assert axis.motion.gusts is not None and axis.motion.gusts.blowing is noticed


@pytest.mark.parametrize("arcsec_s", [0.0, 100.0])
@pytest.mark.parametrize("mode", [AxisMode.RATE, AxisMode.CLASS])
def test_B1_wind_is_noticed_at_a_locked_rate(mode: AxisMode, arcsec_s: float) -> None:
    axis = Axis()
    axis.motion.set_lock(1)
    axis.motion.run(mode, rate_q16(arcsec_s))
    for k in range(2200):
        axis.run(1, velocity=round(arcsec_s * 0.43556) + (3 if k // 33 % 2 else -3))
    assert axis.gains == WINDY


@pytest.mark.parametrize("mode", [AxisMode.RATE, AxisMode.CLASS, AxisMode.MOVE])
def test_B1_with_the_lock_on_there_are_gains_for_still_air_and_for_wind(mode: AxisMode) -> None:
    axis = Axis()
    if mode is AxisMode.MOVE:
        axis.motion.move(0, 0, PLACE, rate_q16(100.0))
    else:
        axis.motion.run(mode, 0)
    axis.motion.set_lock(1)
    assert axis.gains == (LOCKED if mode is not AxisMode.MOVE else (2.0, 0.01))
    axis.run(1)
    assert axis.gains == LOCKED
    shaken = [axis.run(1, velocity=3 if k // 33 % 2 else -3) for k in range(2500)]  # 3 Hz, 6 counts
    assert shaken and axis.gains == WINDY
    axis.motion.set_lock(0)
    assert axis.gains == (PLAIN if mode is not AxisMode.MOVE else (2.0, 0.04))
    axis.run(1)
    assert axis.gains == (PLAIN if mode is not AxisMode.MOVE else CREEPING)


@pytest.mark.parametrize("again", ["rate", "track"])
def test_B1_wind_is_sought_anew_in_another_mode_and_at_creeping_speed_only(again: str) -> None:
    axis = Axis()
    axis.motion.set_lock(1)
    axis.motion.run(AxisMode.RATE, 0)
    gusts = axis.motion.gusts
    assert gusts is not None
    gusts.blowing = True
    axis.run(1)
    assert axis.gains == WINDY
    if again == "rate":
        axis.motion.run(AxisMode.RATE, rate_q16(200.0))
        assert axis.gains == LOCKED
    else:
        axis.motion.track(0, 0, rate_q16(200.0))
        axis.run(1)
        assert axis.gains == LOCKED
    axis.run(20)
    for k in range(2500):
        axis.run(1, velocity=90 if k // 33 % 2 else 84)
    assert not gusts.blowing


def test_B1_a_lock_that_is_switched_on_or_started_anew_owes_nothing() -> None:
    """At rest three ticks of a count are owed; 6/s of them, as in the position loop, come on top."""
    axis = Axis()
    axis.motion.set_lock(1)
    gain = round(6.0 / 200 * 65536)
    axis.motion.run(AxisMode.RATE, 0)
    owed = [axis.run(1, velocity=-1) for _ in range(3)]
    lock = RateLock(gain)
    assert owed == [lock.step(0, -1) for _ in range(3)] == [gain, 2 * gain, 3 * gain]
    axis.motion.run(AxisMode.RATE, 0)
    assert axis.run(1, velocity=-1) == gain
    axis.motion.set_lock(1)
    assert axis.run(1, velocity=-1) == gain
    axis.motion.run(AxisMode.STOP, 0)
    assert axis.run(1, velocity=-1) == 0


def test_B1_a_blend_begins_anew_where_the_position_loop_does() -> None:
    """Frames jump by 100 arcsec while another mode drives: the blend must not creep there."""
    axis = Axis()
    axis.motion.set_blend(10)
    axis.motion.track(0, 0, 0)
    axis.run(5)
    axis.motion.run(AxisMode.RATE, 0)
    axis.at(PLACE + steps(100.0))
    axis.motion.track(0, 0, 0)
    assert abs(axis.run(2)) < 4
    axis.at(PLACE + steps(101.0))
    assert abs(axis.run(1)) < rate_q16(0.01)  # a thousandth of the 6 arcsec/s it would be without
    axis.motion.set_blend(0)
    assert axis.run(1) == pytest.approx(-rate_q16(6.0), rel=0.01)
