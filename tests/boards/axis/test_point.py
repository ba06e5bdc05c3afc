"""The position loop by hand: 6/s times the error, at most 1500″/s, a reference that waits, gains by rate."""

import pytest

from boards.axis.config import steps
from boards.axis.motion import Motion
from boards.axis.pi import IncrementalPi
from boards.axis.profile import UNITS_PER_STEP
from bus.protocol import pack_position
from bus.protocol.scales import rate_q16
from tests.boards.lab import axis_config

PLACE = 200_000_000
CONFIG = axis_config(ki_pointing=0.5, ki_creep=0.25)


def at(position: int, axis: Motion | None = None) -> Motion:
    """A board whose axis stands here, as a frame without age tells at time 0."""
    found = axis or Motion(CONFIG, IncrementalPi(0, 0, 3000))
    found.take_position(CONFIG.frame_ns, pack_position(0x21, 0, position, 0, 1))
    return found


@pytest.mark.parametrize(("off_arcsec", "rate_arcsec_s"), [
    (10.0, 60.0), (100.0, 600.0), (300.0, 1500.0), (-10.0, -60.0), (-100.0, -600.0), (-300.0, -1500.0),
])  # fmt: skip
def test_B2_an_error_is_taken_out_at_six_times_its_size(off_arcsec: float, rate_arcsec_s: float) -> None:
    axis = at(PLACE)
    axis.track(0, 0, 0)
    at(PLACE - steps(off_arcsec), axis)
    assert axis.setpoint(0, 0) == pytest.approx(rate_q16(rate_arcsec_s), rel=1e-4)


@pytest.mark.parametrize("sign", [1, -1])
def test_B2_the_reference_waits_900_arcsec_before_an_axis_that_does_not_follow(sign: int) -> None:
    axis = at(PLACE)
    axis.move(0, 0, PLACE + sign * steps(36_000.0), rate_q16(7200.0))
    ahead = 0
    for _ in range(1000):  # 5 s at 7200″/s would be far beyond the target
        axis.setpoint(0, 0)
        ahead = axis.profile.target - axis.profile.remaining - PLACE * UNITS_PER_STEP
        assert abs(ahead) <= steps(900.0) * UNITS_PER_STEP
    assert sign * ahead == pytest.approx(steps(900.0) * UNITS_PER_STEP)


@pytest.mark.parametrize(("rate_arcsec_s", "ki"), [
    (0.0, 0.25), (15.0, 0.25), (-199.0, 0.25), (201.0, 0.5), (-600.0, 0.5),
])  # fmt: skip
def test_B2_creeping_below_200_arcsec_a_second_has_its_own_integral_gain(
    rate_arcsec_s: float, ki: float
) -> None:
    pi = IncrementalPi(0, 0, 3000)
    axis = at(PLACE, Motion(CONFIG, pi))
    axis.track(0, 0, rate_q16(rate_arcsec_s))
    for _ in range(100):  # until the profile has reached the rate
        axis.setpoint(0, 0)
    assert pi.ki_q12 == ki * 4096


@pytest.mark.parametrize("after_arcsec_s", [0.0, -600.0, 900.0])
def test_B2_another_tracking_rate_is_reached_with_the_acceleration(after_arcsec_s: float) -> None:
    """2°/s² are 36″/s in a tick. The axis stands 300″ behind, so the correction stays at its 1500″/s."""
    axis = at(PLACE)
    axis.track(0, 0, rate_q16(600.0))
    before = [axis.setpoint(0, 0) for _ in range(100)][-1]
    axis.track(0, 0, rate_q16(after_arcsec_s))
    for _ in range(10):
        setpoint = axis.setpoint(0, 0)
        assert abs(setpoint - before) <= rate_q16(36.1)
        before = setpoint
