"""The sky against published values: Meeus' examples, ERFA's own vector, Bennett's refraction."""

import dataclasses
import datetime as dt
import math

import erfa
import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from bus.units import ARCSEC_PER_RAD
from host.sky.angles import parse_declination, parse_right_ascension, wrap_pi
from host.sky.catalogue import Star, star
from host.sky.observed import Clock, observe, observe_many, rates
from host.sky.site import NAINITAL, Site, standard_pressure_hpa

VACUUM = dataclasses.replace(NAINITAL, pressure_hpa=0.0)
# ERFA's refraction (atioq) has a corner here: below it the unrefracted sin(altitude) is held at 0.05
LOWEST_RAD = math.asin(0.05)
EVENING = Clock(dt.datetime(2026, 2, 10, 14, 0, tzinfo=dt.UTC))


def test_erfa_vector_for_catalogue_to_observed() -> None:
    """`t_atco13` of ERFA/SOFA's published test programme, reached through our Site, Star and Clock."""
    site = Site(
        latitude_rad=-1.2345856, longitude_rad=-0.527800806, height_m=2738.0, pressure_hpa=731.0,
        temperature_c=12.8, humidity=0.59, wavelength_um=0.55, ut1_minus_utc_s=0.1550675,
        polar_motion_x_rad=2.47230737e-7, polar_motion_y_rad=1.82640464e-6,
    )  # fmt: skip
    mas = ARCSEC_PER_RAD * 1000
    target = Star("vector", 2.71, 0.174, 1e-5 * mas * math.cos(0.174), 5e-6 * mas, 100.0)
    clock = Clock(dt.datetime(2013, 4, 2, 23, 15, 43, 550006, tzinfo=dt.UTC))  # JD 2456384.969254051
    seen = observe(target, site, clock, 0.0)
    # Our clock has microseconds and no radial velocity: both are far below 1e-8 rad (0.002″) here.
    assert wrap_pi(seen.hour_angle_rad - -0.9265154431529724692e-1) == pytest.approx(0.0, abs=1e-8)
    assert seen.declination_rad == pytest.approx(0.1716626560072526200, abs=1e-8)
    assert seen.azimuth_rad == pytest.approx(0.9251774485485515906e-1, abs=1e-8)
    assert math.pi / 2 - seen.altitude_rad == pytest.approx(1.407661405256499357, abs=1e-8)


def test_meeus_theta_persei_apparent_place() -> None:
    """Meeus, Astronomical Algorithms, example 23.a: θ Persei on 2028 November 13.19 TD."""
    theta_persei = Star(
        "theta Persei", parse_right_ascension("02:44:11.986"), parse_declination("+49:13:42.48"),
        pm_ra_mas_yr=0.03425 * 15 * 1000 * math.cos(math.radians(49.2285)), pm_dec_mas_yr=-89.5,
    )  # fmt: skip
    clock = Clock(dt.datetime(2028, 11, 13, 4, 32, 26, tzinfo=dt.UTC))  # 04:33:36 TD less about 70 s
    seen = observe(theta_persei, VACUUM, clock, 0.0)
    day, fraction = clock.julian(0.0)
    sidereal = erfa.gst06a(day, fraction, day, fraction + 70 / 86400) + NAINITAL.longitude_rad
    right_ascension = wrap_pi(sidereal - seen.hour_angle_rad)
    # 0.5″: the published place is geocentric (diurnal aberration is up to 0.3″) and has IAU 1980 nutation.
    published_ra, published_dec = parse_right_ascension("02:46:14.390"), parse_declination("+49:21:07.45")
    difference = wrap_pi(right_ascension - published_ra) * ARCSEC_PER_RAD * math.cos(published_dec)
    assert abs(difference) < 0.5
    assert abs(seen.declination_rad - published_dec) * ARCSEC_PER_RAD < 0.5


def test_meeus_sidereal_time_fixes_the_hour_angle() -> None:
    """Meeus, example 12.a: apparent sidereal time at Greenwich 1987 April 10, 0h UT is 13h10m46.1351s."""
    greenwich = dataclasses.replace(VACUUM, longitude_rad=0.0, latitude_rad=math.radians(51.5))
    clock = Clock(dt.datetime(1987, 4, 10, tzinfo=dt.UTC))
    vega = star("Vega")
    seen = observe(vega, greenwich, clock, 0.0)
    day, fraction = clock.julian(0.0)
    apparent_ra, _, _ = erfa.atci13(
        vega.right_ascension_rad, vega.declination_rad,
        vega.pm_ra_mas_yr / 1000 / ARCSEC_PER_RAD / math.cos(vega.declination_rad),
        vega.pm_dec_mas_yr / 1000 / ARCSEC_PER_RAD, vega.parallax_mas / 1000, 0.0, day, fraction + 55 / 86400,
    )  # fmt: skip
    equation_of_origins = erfa.eo06a(day, fraction)
    sidereal_h = math.degrees(seen.hour_angle_rad + apparent_ra - equation_of_origins) / 15 % 24
    published_h = 13 + 10 / 60 + 46.1351 / 3600
    # UT1 − UTC was up to −0.5 s that day (Meeus works in UT1), diurnal aberration adds 0.02 s.
    assert abs(sidereal_h - published_h) * 3600 < 0.6


@pytest.mark.parametrize("altitude_deg", [20.0, 35.0, 60.0])
def test_refraction_is_that_of_bennett(altitude_deg: float) -> None:
    """Bennett 1982 (Meeus 16.3), scaled to the site's pressure and temperature,
    which states 0.07′.
    """
    times = np.linspace(0, 12 * 3600, 7200)
    _, _, true, _ = observe_many(star("Aldebaran"), VACUUM, EVENING, times)
    _, _, lifted, _ = observe_many(star("Aldebaran"), NAINITAL, EVENING, times)
    index = int(np.argmin(np.abs(np.degrees(lifted) - altitude_deg)))
    refraction = (lifted[index] - true[index]) * ARCSEC_PER_RAD
    seen_deg = math.degrees(lifted[index])
    bennett = 60 / math.tan(math.radians(seen_deg + 7.31 / (seen_deg + 4.4)))
    bennett *= NAINITAL.pressure_hpa / 1010 * 283 / (273 + NAINITAL.temperature_c)
    assert refraction == pytest.approx(bennett, abs=0.07 * 60)


def test_rates_in_vacuum_are_sidereal_and_refraction_slows_them_in_the_west() -> None:
    sidereal = 15.041067  # ″/s, the Earth's rotation (IERS: 7.292115e-5 rad/s)
    aldebaran = star("Aldebaran")
    assert rates(aldebaran, VACUUM, EVENING, 0.0).hour_angle_arcsec_s == pytest.approx(sidereal, abs=2e-4)
    west = rates(aldebaran, NAINITAL, EVENING, 4 * 3600.0)
    assert sidereal - 0.1 < west.hour_angle_arcsec_s < sidereal - 0.005
    assert west.declination_arcsec_s > 0.0  # lifted towards the zenith, which is north of it


@example(21746.0, "Rigel")  # at the corner
@given(st.floats(0, 36000), st.sampled_from(["Vega", "Rigel", "Polaris"]))
def test_rates_carry_the_place_along(t_s: float, name: str) -> None:
    here, there = observe(star(name), NAINITAL, EVENING, t_s), observe(star(name), NAINITAL, EVENING, t_s + 1)
    unrefracted = observe(star(name), VACUUM, EVENING, t_s + 0.5).altitude_rad
    assume(abs(unrefracted - LOWEST_RAD) > math.radians(0.01))  # two seconds of time and more
    rate = rates(star(name), NAINITAL, EVENING, t_s + 0.5)
    moved = wrap_pi(there.hour_angle_rad - here.hour_angle_rad) * ARCSEC_PER_RAD
    assert moved == pytest.approx(rate.hour_angle_arcsec_s, abs=2e-3)


def test_pressure_at_sea_level_and_at_the_site() -> None:
    assert standard_pressure_hpa(0.0) == 1013.25
    assert 780 < NAINITAL.pressure_hpa < 830  # US standard atmosphere 1976 at 1950 m: 801 hPa


def test_a_time_without_zone_is_refused() -> None:
    with pytest.raises(ValueError, match="time zone"):
        Clock(dt.datetime(2026, 2, 10))
