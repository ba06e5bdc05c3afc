"""A mount with errors: what spherical geometry says of each of them, and its section of a plant file."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from plant import model
from plant.model import ModelError
from plant.mount import sky
from plant.parts import MountErrors, Number

LATITUDE = math.radians(29 + 22 / 60)
PERFECT = {each.name: Number(0.0, "arcsec", "test") for each in dataclasses.fields(MountErrors)}
LARGE_DEG = 0.4
"""Formulas of first order would be off by 10″ here."""
HOUR_ANGLES, DECLINATIONS = np.radians([[-70.0, -20.0, 0.0, 35.0, 60.0], [20.0, 60.0, -10.0, 5.0, 80.0]])


def only(**arcsec: float) -> MountErrors:
    return MountErrors(**PERFECT | {name: Number(value, "arcsec", "test") for name, value in arcsec.items()})


def horizontal(h: Any, d: Any) -> tuple[Any, Any]:
    """Altitude, and azimuth from the south westwards (Meeus 13.5, 13.6)."""
    sine = np.sin(LATITUDE) * np.sin(d) + np.cos(LATITUDE) * np.cos(d) * np.cos(h)
    azimuth = np.arctan2(np.sin(h), np.cos(h) * np.sin(LATITUDE) - np.tan(d) * np.cos(LATITUDE))
    return np.arcsin(sine), azimuth


def apart(h: Any, d: Any, other_h: Any, other_d: Any) -> Any:
    """Angle between two directions, by the haversine."""
    half = np.sin((d - other_d) / 2) ** 2 + np.cos(d) * np.cos(other_d) * np.sin((h - other_h) / 2) ** 2
    return 2 * np.arcsin(np.sqrt(half))


def test_a_perfect_mount_looks_where_its_axes_stand() -> None:
    h, d = sky(HOUR_ANGLES, DECLINATIONS, LATITUDE, only())
    assert h == pytest.approx(HOUR_ANGLES, abs=1e-13)
    assert d == pytest.approx(DECLINATIONS, abs=1e-13)


def test_zeros_are_plain_differences() -> None:
    h, d = sky(HOUR_ANGLES, DECLINATIONS, LATITUDE, only(hour_angle_index=1800, declination_index=-1800))
    assert np.degrees(HOUR_ANGLES - h) == pytest.approx(0.5)
    assert np.degrees(DECLINATIONS - d) == pytest.approx(-0.5)


@pytest.mark.parametrize(("azimuth", "altitude"), [(1440, 0), (0, 1440), (900, -1200)])
def test_the_axis_pole_lies_off_the_true_one_by_the_misalignment(azimuth: float, altitude: float) -> None:
    errors = only(polar_azimuth=azimuth, polar_altitude=altitude)
    _, d = sky(0.3, math.pi / 2, LATITUDE, errors)
    assert math.degrees(math.pi / 2 - float(d)) * 3600 == pytest.approx(math.hypot(azimuth, altitude))
    # Angles between directions stay: the mount is turned as a whole.
    h, d = sky(HOUR_ANGLES, DECLINATIONS, LATITUDE, errors)
    before = apart(HOUR_ANGLES[1:], DECLINATIONS[1:], HOUR_ANGLES[:-1], DECLINATIONS[:-1])
    assert apart(h[1:], d[1:], h[:-1], d[:-1]) == pytest.approx(before, abs=1e-12)


def test_a_cone_keeps_the_sight_at_one_angle_from_the_declination_axis() -> None:
    h, d = sky(HOUR_ANGLES, DECLINATIONS, LATITUDE, only(collimation=LARGE_DEG * 3600))
    axis = np.stack([-np.sin(HOUR_ANGLES), np.cos(HOUR_ANGLES), 0 * h])
    sight = np.stack([np.cos(d) * np.cos(h), np.cos(d) * np.sin(h), np.sin(d)])
    assert np.degrees(np.arccos(np.sum(axis * sight, axis=0))) == pytest.approx(90 + LARGE_DEG)


def test_a_tilted_declination_axis_never_reaches_the_pole() -> None:
    around = np.linspace(0.0, math.pi, 2001)
    _, d = sky(0.0 * around, around, LATITUDE, only(non_perpendicularity=LARGE_DEG * 3600))
    assert np.degrees(np.max(d)) == pytest.approx(90 - LARGE_DEG, abs=1e-6)


def test_an_encoder_off_its_centre_reads_most_a_quarter_turn_away() -> None:
    """Reading less angle of the shaft: a sine of its turn, nothing at 0, all of it at 90 degrees."""
    errors = only(hour_angle_eccentricity=30, declination_eccentricity=-20)
    places = np.radians([0.0, 30.0, 90.0])
    h, d = sky(places, places, LATITUDE, errors)
    assert np.degrees(places - h)[:2] * 3600 == pytest.approx([0, 15], abs=0.01)
    assert np.degrees(places - d)[:2] * 3600 == pytest.approx([0, -10], abs=0.01)
    h, d = sky(-math.pi / 2, math.radians(-45), LATITUDE, errors)
    assert math.degrees(-math.pi / 2 - float(h)) * 3600 == pytest.approx(-30)
    assert math.degrees(math.radians(-45) - float(d)) * 3600 == pytest.approx(20 * math.sqrt(0.5), abs=0.01)


def test_a_drooping_tube_loses_altitude_and_no_azimuth() -> None:
    h, d = sky(HOUR_ANGLES, DECLINATIONS, LATITUDE, only(tube_flexure=-300))
    before, after = horizontal(HOUR_ANGLES, DECLINATIONS), horizontal(h, d)
    assert np.degrees(before[0] - after[0]) * 3600 == pytest.approx(300 * np.cos(before[0]))
    assert after[1] == pytest.approx(before[1], abs=1e-12)


def test_refraction_left_over_grows_with_tan_z_and_ends_at_five_degrees() -> None:
    h, d = sky(HOUR_ANGLES, DECLINATIONS, LATITUDE, only(refraction=60))
    before, after = horizontal(HOUR_ANGLES, DECLINATIONS), horizontal(h, d)
    high = before[0] > math.radians(5)
    lift = np.degrees(after[0] - before[0]) * 3600
    assert lift[high] == pytest.approx(60 / np.tan(before[0][high]))
    low = sky(math.radians(95), math.radians(5), LATITUDE, only(refraction=60))
    assert np.all(np.isfinite(low))


def test_a_sagging_declination_axis_moves_the_sight_along_it() -> None:
    """A small turn about the level line across it: west by the sine of the altitude."""
    h, d = sky(HOUR_ANGLES, DECLINATIONS, LATITUDE, only(axis_flexure=10))
    altitude, _ = horizontal(HOUR_ANGLES, DECLINATIONS)
    west = (h - HOUR_ANGLES) * np.cos(d)
    assert np.degrees(west) * 3600 == pytest.approx(10 * np.sin(altitude), abs=0.01)
    assert np.degrees(d - DECLINATIONS) * 3600 == pytest.approx(0, abs=0.01)


def test_a_plant_file_without_the_section_has_no_errors() -> None:
    plain = model.load("low_preload")
    assert plain.mount is None
    assert "\nmount:" not in model.dumps(plain)
    assert not any(path.startswith("mount") for path in model.numbers(plain))


def test_the_section_is_read_back_and_what_it_leaves_out_is_typical() -> None:
    text = model.dumps(model.load("low_preload"))
    given = "mount:\n  polar_azimuth: {value: 2, unit: arcsec, source: measured}\n"
    mount = model.loads(text + given).mount
    assert mount is not None
    assert mount.polar_azimuth == Number(2.0, "arcsec", "measured")
    assert mount.collimation == MountErrors().collimation
    both = model.with_mount_errors(model.load("low_preload"))
    assert model.loads(model.dumps(both)) == both
    assert model.get(both, "mount.tube_flexure").unit == "arcsec"


def test_every_typical_number_says_that_it_is_assumed_and_keeps_its_bounds() -> None:
    for each in dataclasses.fields(MountErrors):
        number = getattr(MountErrors(), each.name)
        assert number.source.startswith("ASSUMPTION")
        assert each.metadata["low"] < number.value < each.metadata["high"]


@pytest.mark.parametrize(("line", "message"), [
    ("  cone: {value: 2, unit: arcsec, source: x}", "mount.cone: unknown field"),
    ("  collimation: {value: 2, unit: deg, source: x}", "2 deg is outside -1800 to 1800 arcsec"),
    ("  collimation: {value: 2, unit: m, source: x}", "'m' does not fit"),
])  # fmt: skip
def test_a_wrong_section_is_one_line(line: str, message: str) -> None:
    text = model.dumps(model.load("low_preload")) + f"mount:\n{line}\n"
    with pytest.raises(ModelError, match=r"plant file, line \d+: mount") as found:
        model.loads(text)
    assert message in str(found.value)
    assert "\n" not in str(found.value)


def test_a_fork_bends_by_the_cosine_of_the_hour_angle() -> None:
    h, d = sky(HOUR_ANGLES, DECLINATIONS, LATITUDE, only(fork_flexure=300))
    assert h == pytest.approx(HOUR_ANGLES, abs=1e-12)
    assert np.degrees(DECLINATIONS - d) * 3600 == pytest.approx(300 * np.cos(HOUR_ANGLES))


def test_below_five_degrees_refraction_stays_what_it_is_there() -> None:
    """At an altitude of one degree: 60 arcsec over sin 5 deg, times the cosine of the altitude."""
    low = math.radians(1.0)
    h, d = sky(math.pi, math.pi / 2 - LATITUDE + low, LATITUDE, only(refraction=60))
    lifted, _ = horizontal(h, d)
    expected = 60 / math.sin(math.radians(5.0)) * math.cos(low)
    assert math.degrees(float(lifted) - low) * 3600 == pytest.approx(expected, rel=1e-6)


def test_shapes_stay() -> None:
    for shape in ((), (3,), (2, 2)):
        h, d = sky(np.full(shape, 0.3), np.full(shape, 0.4), LATITUDE, MountErrors())
        assert h.shape == d.shape == shape
