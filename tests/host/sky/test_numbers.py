"""Constants and bounds of the sky's modules, from where they are written elsewhere."""

import dataclasses
import datetime as dt
import math

import pytest

from host.sky.angles import format_degrees, parse_declination, parse_right_ascension
from host.sky.catalogue import STARS, star
from host.sky.mount import AxisScale, limits_mount, scale_from_limits
from host.sky.observed import (
    Clock,
    Place,
    apparent_of_observed,
    equatorial,
    horizontal,
    observe,
    rates,
    sidereal_time_rad,
    star_of_apparent,
)  # fmt: skip
from host.sky.site import NAINITAL, Site, standard_pressure_hpa
from host.sky.visibility import BelowHorizon, Observatory, Unreachable, check_reachable

DEG = math.pi / 180
NIGHT = Clock(dt.datetime(2026, 2, 10, 14, 0, tzinfo=dt.UTC))


def test_the_site_is_the_papers() -> None:
    """Section 2.1: 29° 22′ N, 79° 27′ E. The pressure of a standard atmosphere at 1950 m, by hand."""
    assert (NAINITAL.latitude_rad, NAINITAL.longitude_rad) == pytest.approx((29.3666667 * DEG, 79.45 * DEG))
    assert (NAINITAL.height_m, NAINITAL.temperature_c, NAINITAL.humidity) == (1950.0, 10.0, 0.5)
    assert NAINITAL.pressure_hpa == pytest.approx(1013.25 * math.exp(-1950 / (29.3 * 283.15)))
    assert standard_pressure_hpa(0.0) == 1013.25 and standard_pressure_hpa(1000.0) == pytest.approx(
        898.2, abs=0.1
    )
    assert standard_pressure_hpa(1000.0, 0.0) == pytest.approx(1013.25 * math.exp(-1000 / (29.3 * 273.15)))
    assert NAINITAL.erfa == (
        0.0, NAINITAL.longitude_rad, NAINITAL.latitude_rad, 1950.0, 0.0, 0.0, NAINITAL.pressure_hpa,
        10.0, 0.5, 0.55,
    )  # fmt: skip


@pytest.mark.parametrize(("fields", "words"), [
    ({"latitude_rad": 1.5709}, "latitude 90.0059° is outside"),
    ({"latitude_rad": -1.5709}, "latitude -90.0059°"),
    ({"humidity": 1.01}, "relative humidity 1.01 is outside 0..1"), ({"humidity": -0.01}, "humidity -0.01"),
])  # fmt: skip
def test_a_place_that_cannot_be_is_refused(fields: dict[str, float], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        dataclasses.replace(NAINITAL, **fields)
    for latitude, humidity in ((math.pi / 2, 0.0), (-math.pi / 2, 1.0)):
        Site(latitude, 0.0, 0.0, 1000.0, 10.0, humidity)


def test_soft_limits_lie_within_the_encoders_turn() -> None:
    turn = 1 << 29
    assert AxisScale(5, 0, 9).steps(math.pi) == 5 + turn // 2
    low = scale_from_limits(0.0, 1.0, zero_steps=0)
    assert (low.low_steps, low.high_steps) == (0, round(turn / (2 * math.pi)))
    high = scale_from_limits(-1.0, 0.0, zero_steps=turn - 1)
    assert high.high_steps == turn - 1
    for zero in (-1, turn):
        with pytest.raises(ValueError, match="encoder's zero"):
            scale_from_limits(*((0.0, 1.0) if zero < 0 else (-1.0, 0.0)), zero_steps=zero)
    with pytest.raises(ValueError, match=r"soft limits 57\.296° and 57\.296° are the wrong way round"):
        scale_from_limits(1.0, 1.0)
    scale = AxisScale(0, -10, 10)
    step = 2 * math.pi / turn
    assert [scale.within(k * step) for k in (-11, -10, 10, 11)] == [False, True, True, False]
    mount = limits_mount(1.0, -0.5, 1.2, 0.3)
    assert mount.ra.angle_rad(mount.ra.low_steps) == pytest.approx(-1.0, abs=1e-8)
    assert mount.ra.angle_rad(mount.ra.high_steps) == pytest.approx(1.0, abs=1e-8)
    assert mount.dec.angle_rad(mount.dec.low_steps) == pytest.approx(-0.5, abs=1e-8)
    assert mount.park_hour_angle_rad == 0.0 and mount.park_declination_rad == 0.3
    assert mount.ra.zero_steps == 1 << 28


@pytest.mark.parametrize(("text", "hours"), [
    ("05:16:41.36", 5 + 16 / 60 + 41.36 / 3600), ("23h59m59.9s", 24 - 0.1 / 3600), ("0 0 0", 0.0),
    ("24:00:00", None),
    ("-00:00:01", None), ("12:60:00", None), ("12:00:60", None), ("12:59:59", 12 + 59 / 60 + 59 / 3600),
])  # fmt: skip
def test_right_ascensions_are_read(text: str, hours: float | None) -> None:
    if hours is None:
        with pytest.raises(ValueError, match="right ascension"):
            parse_right_ascension(text)
        return
    assert parse_right_ascension(text) == pytest.approx(hours * math.pi / 12)


@pytest.mark.parametrize(("text", "degrees"), [
    ("+45:59:52.8", 45 + 59 / 60 + 52.8 / 3600), ("−45°59′52.8″", -(45 + 59 / 60 + 52.8 / 3600)),
    ("-00:30:00", -0.5),
    ("90:00:00", 90.0), ("90:00:00.1", None), ("-90:00:01", None), ("+12:60:00", None), ("+12:00:60", None),
])  # fmt: skip
def test_declinations_are_read(text: str, degrees: float | None) -> None:
    if degrees is None:
        with pytest.raises(ValueError, match="declination"):
            parse_declination(text)
        return
    assert parse_declination(text) == pytest.approx(degrees * DEG)


@pytest.mark.parametrize(("degrees", "text"), [
    (0.0, "+00°00′00.0″"), (-0.5, "−00°30′00.0″"), (123 + 45 / 60 + 6.78 / 3600, "+123°45′06.8″"),
    (59.99 / 60, "+00°59′59.4″"), (1 - 0.01 / 3600, "+01°00′00.0″"),
])  # fmt: skip
def test_degrees_are_written(degrees: float, text: str) -> None:
    assert format_degrees(degrees * DEG) == text


def test_a_clock_is_utc_to_the_millisecond() -> None:
    """2026-02-10 is the Julian day 2461081.5."""
    india = Clock(dt.datetime(2026, 2, 10, 19, 30, 1, 500_000, tzinfo=dt.timezone(dt.timedelta(hours=5.5))))
    assert india.iso(0.0) == "2026-02-10T14:00:01.500Z" and india.iso(1.0625) == "2026-02-10T14:00:02.562Z"
    day, fraction = india.julian(60.0)
    assert day + fraction == pytest.approx(2461081.5 + (14 * 3600 + 61.5) / 86400, abs=1e-9)
    assert fraction - india.julian(0.0)[1] == pytest.approx(60 / 86400)
    with pytest.raises(ValueError, match="start_utc has no time zone"):
        Clock(dt.datetime(2026, 2, 10))


def test_sidereal_time_is_the_textbooks() -> None:
    """Meeus 12.4, mean time at Greenwich; the equation of the equinoxes is below 1.2 s."""
    days = 2461081.5 + 14 / 24 - 2451545.0
    degrees = 280.46061837 + 360.98564736629 * days + 79.45
    found = math.degrees(sidereal_time_rad(NAINITAL, NIGHT, 0.0))
    assert math.remainder(found - degrees, 360) == pytest.approx(0.0, abs=1.2 * 15 / 3600)
    hour = math.degrees(sidereal_time_rad(NAINITAL, NIGHT, 3600.0)) - found
    assert hour == pytest.approx(15.041067, abs=1e-5)
    late = dataclasses.replace(NAINITAL, ut1_minus_utc_s=0.5)
    assert math.degrees(sidereal_time_rad(late, NIGHT, 0.0)) - found == pytest.approx(
        0.5 * 15.041 / 3600, abs=1e-7
    )


def test_places_go_there_and_back() -> None:
    for azimuth_deg, altitude_deg in ((10.0, 40.0), (200.0, 70.0), (300.0, 20.0)):
        there = equatorial(azimuth_deg * DEG, altitude_deg * DEG, NAINITAL)
        assert (there.azimuth_rad, there.altitude_rad) == (azimuth_deg * DEG, altitude_deg * DEG)
        assert abs(there.hour_angle_rad) <= math.pi
        back = horizontal(there.hour_angle_rad, there.declination_rad, NAINITAL)
        assert (back.azimuth_rad, back.altitude_rad) == pytest.approx((azimuth_deg * DEG, altitude_deg * DEG))
    star_here = star_of_apparent(Place(1.0, 0.3), NIGHT, 0.0, "x")
    seen = observe(star_here, NAINITAL, NIGHT, 0.0)
    back_again = apparent_of_observed(seen.hour_angle_rad, seen.declination_rad, NAINITAL, NIGHT, 0.0)
    assert back_again == pytest.approx((1.0, 0.3), abs=1e-6) and star_here.name == "x"


def test_rates_are_differences_of_places() -> None:
    found = rates(STARS["Capella"], NAINITAL, NIGHT, 100.0)
    early, late = (observe(STARS["Capella"], NAINITAL, NIGHT, 100.0 + k) for k in (-5.0, 5.0))
    arcsec = 648000 / math.pi
    assert found.hour_angle_arcsec_s == pytest.approx((late[0] - early[0]) * arcsec / 10, abs=1e-4)
    assert found.declination_arcsec_s == pytest.approx((late[1] - early[1]) * arcsec / 10, abs=1e-4)


def test_reach_is_asked_for_all_the_time_of_a_track() -> None:
    """Every ten seconds: a star that meets a limit is told with the time."""
    mount = limits_mount(80 * DEG, -45 * DEG, 85 * DEG, 0.5)
    about = Observatory(NAINITAL, NIGHT, mount)
    assert about.horizon_rad == pytest.approx(15 * DEG) and about.name == "Nainital"
    here = sidereal_time_rad(NAINITAL, NIGHT, 0.0)
    west = star_of_apparent(Place((here - 79.5 * DEG) % (2 * math.pi), 50 * DEG), NIGHT, 0.0, "west")
    check_reachable(west, about, 0.0)
    check_reachable(west, about, 0.0, 60.0)
    with pytest.raises(
        Unreachable, match=r"west is at hour angle \+80°.*before the track ends.*-80\.0°\.\.80\.0°"
    ):
        check_reachable(west, about, 0.0, 300.0)
    low = star_of_apparent(Place((here + 60 * DEG) % (2 * math.pi), -20 * DEG), NIGHT, 0.0, "low")
    with pytest.raises(
        BelowHorizon,
        match=r"when it is to be reached \(2026-02-10T14:00:00Z\), below the horizon limit of 15°",
    ):
        check_reachable(low, about, 0.0)
    with pytest.raises(BelowHorizon):
        check_reachable(low, about, 0.0, 20000.0)


def test_a_name_that_is_not_known_gets_the_nearest_or_none() -> None:
    assert star("VEGA").name == "Vega"
    with pytest.raises(ValueError, match=r"no star called 'Siriuz' in the catalogue; did you mean Sirius\?"):
        star("Siriuz")
    with pytest.raises(ValueError, match="give ra and dec instead"):
        star("qqqqqqq")
