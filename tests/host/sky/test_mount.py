"""Axis scales, reachability, angles and the catalogue."""

import datetime as dt
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.units import ARCSEC_PER_RAD
from host.sky.angles import format_degrees, parse_declination, parse_right_ascension, wrap_pi
from host.sky.catalogue import STARS, star
from host.sky.mount import STEP_ARCSEC, limits_mount, scale_from_limits
from host.sky.observed import Clock, observe
from host.sky.site import NAINITAL
from host.sky.visibility import Observatory, Unreachable, check_reachable

MOUNT = limits_mount(math.radians(100), math.radians(-35), math.radians(89.9), NAINITAL.latitude_rad)
EVENING = Clock(dt.datetime(2026, 2, 10, 14, 0, tzinfo=dt.UTC))


@given(st.floats(-1.7, 1.7))
def test_P8_steps_and_angles_agree_within_half_a_step(angle_rad: float) -> None:
    error_rad = MOUNT.ra.angle_rad(MOUNT.ra.steps(angle_rad)) - angle_rad
    assert abs(error_rad) * ARCSEC_PER_RAD <= STEP_ARCSEC * 0.5001


def test_H4_alignment_offset_moves_the_zero() -> None:
    off = MOUNT.ra.aligned(1000)
    assert off.steps(0.3) - MOUNT.ra.steps(0.3) == 1000


def test_limits_the_wrong_way_round_are_refused() -> None:
    with pytest.raises(ValueError, match="wrong way round"):
        scale_from_limits(1.0, -1.0)
    with pytest.raises(ValueError, match="encoder's zero"):
        scale_from_limits(-3.0, 3.0, zero_steps=1000)


def test_a_star_below_the_horizon_is_refused_with_its_altitude() -> None:
    with pytest.raises(Unreachable, match=r"Antares is at altitude −.*below the horizon"):
        check_reachable(star("Antares"), Observatory(NAINITAL, EVENING, MOUNT), 0.0)


def test_a_star_that_sets_during_the_track_is_refused() -> None:
    wide = limits_mount(math.radians(150), math.radians(-35), math.radians(85), NAINITAL.latitude_rad)
    place = Observatory(NAINITAL, EVENING, wide, horizon_rad=math.radians(2))
    check_reachable(star("Deneb"), place, 0.0, 0.0)
    with pytest.raises(Unreachable, match="before the track ends"):
        check_reachable(star("Deneb"), place, 0.0, 3600.0)


def test_a_star_beyond_the_soft_limits_is_refused() -> None:
    narrow = limits_mount(math.radians(30), math.radians(-35), math.radians(85), NAINITAL.latitude_rad)
    place = Observatory(NAINITAL, EVENING, narrow)
    with pytest.raises(Unreachable, match=r"Pollux is at hour angle −46°.*soft limits"):
        check_reachable(star("Pollux"), place, 0.0)
    with pytest.raises(Unreachable, match="Polaris is at declination"):
        check_reachable(star("Polaris"), place, 0.0)


def test_stars_are_found_in_any_case_and_a_typo_gets_a_hint() -> None:
    assert star("aldebaran").hipparcos == 21421
    with pytest.raises(ValueError, match="did you mean Aldebaran"):
        star("Aldebarran")
    assert len(STARS) >= 20


def test_altitude_and_azimuth_agree_with_spherical_trigonometry() -> None:
    """Meeus 13.5/13.6 on the observed hour angle and declination."""
    for each in STARS.values():
        seen = observe(each, NAINITAL, EVENING, 0.0)
        lat = NAINITAL.latitude_rad
        sine = math.sin(lat) * math.sin(seen.declination_rad) + math.cos(lat) * math.cos(
            seen.declination_rad
        ) * math.cos(seen.hour_angle_rad)
        assert math.asin(sine) == pytest.approx(seen.altitude_rad, abs=1e-9)


@given(st.floats(-1.5, 1.5))
def test_declinations_survive_printing_and_reading(angle_rad: float) -> None:
    assert abs(parse_declination(format_degrees(angle_rad)) - angle_rad) * ARCSEC_PER_RAD < 0.051


@pytest.mark.parametrize("text", ["25:00:00", "-01:00:00", "5h", "05:61:00", "x"])
def test_bad_right_ascensions_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match="right ascension"):
        parse_right_ascension(text)


@given(st.floats(-100, 100))
def test_wrapped_angles_are_the_same_angle(angle_rad: float) -> None:
    assert math.cos(wrap_pi(angle_rad)) == pytest.approx(math.cos(angle_rad), abs=1e-9)
    assert abs(wrap_pi(angle_rad)) <= math.pi + 1e-12
