"""What an axis board is programmed with, against the paper's figures and the sums in the file's comments."""

from dataclasses import replace

import pytest

from boards.axis import config
from boards.axis.config import AxisPeers, settings, steps
from calibration.balances.effortchange import CREEP_RATE
from tests.boards.lab import axis_config
from tests.boards.tables import times_ns

Q16_PER_ARCSEC_S = 112_896_000 / 1_296_000 / 200 * 65536
"""Counts of the incremental encoder per turn, 5 ms (paper, sections 2.2, 3.2 and 3.3)."""
PEERS = AxisPeers(position=0x21, motor_a=0x31, motor_b=0x32, auxiliary=0x23)


def test_rates_are_those_of_table_1_and_of_the_sky() -> None:
    wanted = axis_config()
    # 12.583 rad/s and rad/s2 at the motor are 2 degrees at the axis: a ratio of 360.5
    slew = 7200 * Q16_PER_ARCSEC_S
    sidereal = 1_296_000 / 86_164.0905
    rates = (slew, *(rate * Q16_PER_ARCSEC_S for rate in (600, 100, 15, round(sidereal, 3))))
    assert wanted.classes == tuple(map(round, rates))
    assert wanted.acceleration == round(slew) // 200
    assert wanted.creep_rate == round(CREEP_RATE * Q16_PER_ARCSEC_S)


def test_angles_are_steps_of_29_bits() -> None:
    assert steps(1_296_000.0) == 1 << 29
    assert steps(-324_000.0) == -(1 << 27)


def test_B1_routines_take_the_times_that_are_published() -> None:
    assert times_ns(config.TABLE, config.FCY_HZ) == {"control": (300, 40_000), "can": (300, 30_000)}
    assert [line.level for line in config.TABLE] == [line.name == "can" for line in config.TABLE]


def test_urgent_routines_come_first_and_the_controllers_takes_5_ms() -> None:
    control, can = config.TABLE
    assert config.PWM_ROUTINE.priority > control.priority > can.priority
    assert config.TICK_NS * 200 == 1_000_000_000


def test_options_take_what_their_parts_take() -> None:
    assert config.SHARE_CYCLES == 15 + 40 + 20
    assert config.LOCK_CYCLES == 30 + 25 + 65 + 20
    assert config.OBSERVER_CYCLES == 25 * 25 + 200 + 75
    assert config.BLEND_CYCLES == 20 + 80


@pytest.mark.parametrize("auxiliary", [0x23, None])
def test_settings_are_fixed_point_and_the_parameters_come_first(auxiliary: int | None) -> None:
    gains = {"kp": 1.5, "ki": 0.25, "kp_pointing": 2.5, "ki_pointing": 0.5, "ki_creep": 0.75}
    gains |= {"kp_gust": 3.0, "ki_gust": 0.125}
    made = axis_config(**gains, position_gain=6.0, split_fade_counts=17)
    told = settings(made, replace(PEERS, auxiliary=auxiliary))
    assert told[:6] == (made.counter_split, 6144, 1024, made.low, made.high, made.acceleration)
    assert told[6:11] == made.classes
    assert told[11:16] == (10240, 2048, 3072, 12288, 512)
    assert told[16:19] == (17, made.pwm_steps, 1966)  # 6/s x 5 ms = 0.03
    assert told[19:23] == (made.correction, made.creep_rate, made.lag_steps, made.settle_steps)
    assert told[23:] == (made.frame_ns, 0x21, 0x31, 0x32, auxiliary or 0)


def test_the_share_fades_only_where_asked() -> None:
    assert axis_config().split_fade_counts == 0
