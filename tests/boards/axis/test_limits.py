"""Soft limits by hand: from 2°/s at 2°/s² an axis needs 1°, and 150 ms until it begins to brake."""

import pytest

from boards.axis.config import steps
from boards.axis.limits import SoftLimits
from boards.axis.motion import Motion
from boards.axis.pi import IncrementalPi
from bus.protocol import AxisMode, PositionFlag
from bus.protocol.scales import rate_q16
from tests.boards.lab import axis_config

LOW, HIGH = steps(36_000.0), steps(360_000.0)
SLEW_COUNTS = 3136  # 7200"/s at 87.1 counts/" (hardware.md 2.1) in 5 ms
NEEDED_ARCSEC = 7200.0**2 / (2 * 7200.0) + 0.15 * 7200.0
AT_PARK = steps(180_000.0)


def limits(
    mode: AxisMode, position: int, setpoint_q16: int = 0, ends: int = 0, slew_arcsec_s: float = 7200.0
) -> SoftLimits:
    """The limits of an axis in a mode, somewhere."""
    config = axis_config(low=LOW, high=HIGH, classes=(rate_q16(slew_arcsec_s),) * 5)
    motion = Motion(config, IncrementalPi(0, 0, 3000))
    motion.mode, motion.position, motion.ends = mode, position, ends
    motion.setpoint_q16 = setpoint_q16
    return SoftLimits(motion)


@pytest.mark.parametrize(("short_arcsec", "stops"), [(20.0, False), (-20.0, True)])
@pytest.mark.parametrize("sign", [1, -1])
def test_B3_a_velocity_is_braked_when_the_way_left_is_the_way_needed(
    sign: int, short_arcsec: float, stops: bool
) -> None:
    way = steps(NEEDED_ARCSEC + short_arcsec)
    found = limits(AxisMode.RATE, HIGH - way if sign > 0 else LOW + way)
    assert found.hit(sign * SLEW_COUNTS) == stops == found.reached
    assert not found.hit(-sign * SLEW_COUNTS)  # inwards


@pytest.mark.parametrize("mode", [AxisMode.MOVE, AxisMode.TRACK])
@pytest.mark.parametrize("sign", [1, -1])
def test_B3_a_position_loop_brakes_by_itself_and_stops_at_the_limit(mode: AxisMode, sign: int) -> None:
    """Its targets lie within; only the limit itself stops it, and that step counts as reached."""
    limit = HIGH if sign > 0 else LOW
    assert not limits(mode, limit - sign).hit(sign * SLEW_COUNTS)
    assert limits(mode, limit).hit(sign)


@pytest.mark.parametrize("mode", [AxisMode.OFF, AxisMode.STOP])
def test_B3_who_brakes_already_is_told_and_not_stopped_again(mode: AxisMode) -> None:
    found = limits(mode, HIGH + 1)
    assert not found.hit(SLEW_COUNTS) and found.reached
    assert limits(AxisMode.RATE, HIGH + 1).hit(SLEW_COUNTS)


@pytest.mark.parametrize(
    ("velocity", "setpoint", "stops"), [(1, 1, True), (1, 0, True), (1, -1, False), (-1, -1, False)]
)
@pytest.mark.parametrize("mirror", [1, -1])
def test_B3_beyond_the_encoder_boards_limit_a_count_of_rest_is_no_motion(
    velocity: int, setpoint: int, stops: bool, mirror: int
) -> None:
    end = PositionFlag.LIMIT_HIGH if mirror > 0 else PositionFlag.LIMIT_LOW
    found = limits(AxisMode.TRACK, AT_PARK, mirror * setpoint, int(end))
    assert found.hit(mirror * velocity) == stops
    assert found.reached


@pytest.mark.parametrize("sign", [1, -1])
def test_B3_a_rate_is_braked_in_time_whatever_the_classes_are(sign: int) -> None:
    """SET_RATE takes 3°/s with a slew class of 600″/s, too: they need 2.25° and 0.15 s of way."""
    counts = round(10_800 * 87.11111 * 0.005)
    way = steps(10_800.0**2 / (2 * 7200.0) + 0.15 * 10_800.0)
    for short, stops in ((20.0, False), (-20.0, True)):
        away = way + steps(short)
        found = limits(AxisMode.RATE, HIGH - away if sign > 0 else LOW + away, slew_arcsec_s=600.0)
        assert found.hit(sign * counts) == stops


@pytest.mark.parametrize(("position", "outside"), [
    (LOW - 1, True), (LOW, False), (AT_PARK, False), (HIGH, False), (HIGH + 1, True),
])  # fmt: skip
def test_B3_at_rest_beyond_a_limit_is_told_and_stops_nothing(position: int, outside: bool) -> None:
    found = limits(AxisMode.RATE, position)
    assert not found.reached  # nobody has looked yet
    assert not found.hit(0)
    assert found.reached is outside is not found.inside(position)
