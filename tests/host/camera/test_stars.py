"""Stars of a field: files, the synthetic sky's counts, and where they are seen."""

import math
from pathlib import Path

import numpy as np
import pytest

from host.camera.models import Look
from host.camera.stars import SyntheticSky, catalogued, from_file, observed, plane, stars, turning
from host.sky.catalogue import STARS
from host.sky.observed import observe
from host.sky.site import NAINITAL
from tests.host.camera.still import POLLUX, pollux
from tests.host.camera.test_frames import CLOCK

DEG = math.pi / 180


def test_a_star_that_is_named_has_the_numbers_of_its_table() -> None:
    """By hand: milliarcseconds to radians, that in right ascension over the cosine."""
    found, mas = pollux(1.0), DEG / 3_600_000
    assert found.pm_ra[0] == pytest.approx(POLLUX.pm_ra_mas_yr * mas / math.cos(POLLUX.declination_rad))
    assert found.pm_dec[0] == pytest.approx(POLLUX.pm_dec_mas_yr * mas)
    assert found.parallax_arcsec[0] == pytest.approx(POLLUX.parallax_mas / 1000)
    named = SyntheticSky().near(POLLUX.right_ascension_rad, POLLUX.declination_rad, 1e-6)
    assert named.magnitude[0] == POLLUX.magnitude == 1.16


def test_a_file_has_stars_that_do_not_move(tmp_path: Path) -> None:
    path = tmp_path / "own.csv"
    path.write_text("name,ra,dec,magnitude\nA,06:00:00,+30:00:00,7.5\nB,12:00:00,-30:00:00,8\n")
    found = from_file(path)
    assert found.right_ascension == pytest.approx([math.pi / 2, math.pi])
    assert found.declination == pytest.approx([math.pi / 6, -math.pi / 6])
    assert list(found.magnitude) == [7.5, 8.0]
    assert not np.any([found.pm_ra, found.pm_dec, found.parallax_arcsec])
    path.write_text("name,ra,dec,magnitude\nA,06:00:00,+30:00:00,\n")
    with pytest.raises(ValueError, match=r"own\.csv: A has no magnitude; a camera needs one"):
        from_file(path)


def test_near_is_within_a_radius() -> None:
    field = stars([0.0, 0.0, 0.1], [0.0, 0.2, 0.0], [1, 2, 3])
    assert list(field.near(0.0, 0.0, 0.15).magnitude) == [1, 3]
    assert list(field.near(0.0, 0.1, 0.1 + 1e-9).magnitude) == [1, 2]
    assert list(field.where(np.array([False, True, False])).magnitude) == [2]


@pytest.mark.parametrize(("ra_deg", "dec_deg"), [(100.3, 0.4), (0.0, 61.0), (200.0, 89.0), (300.0, -88.5)])
def test_the_synthetic_sky_has_as_many_stars_as_allens(ra_deg: float, dec_deg: float) -> None:
    """7.9 to 10 mag in a square degree, and 10^0.43 times more for every magnitude, evenly spread."""
    found = SyntheticSky().near(ra_deg * DEG, dec_deg * DEG, 2 * DEG)
    cap_deg2 = 2 * math.pi * (1 - math.cos(2 * DEG)) / DEG**2
    expected = 7.9 * 10 ** (4 * 0.43) * cap_deg2
    assert len(found.magnitude) == pytest.approx(expected, abs=5 * math.sqrt(expected))
    brighter = np.count_nonzero(found.magnitude < 13)
    assert brighter == pytest.approx(expected / 10**0.43, abs=5 * math.sqrt(brighter))
    assert np.sort(found.magnitude)[2] >= 4.0 and 13.99 < found.magnitude.max() <= 14.0
    here = Look(0, 0.0, dec_deg * DEG)
    right, up = plane(found.right_ascension - ra_deg * DEG, found.declination, here)
    for quarter in (right > np.abs(up), right < -np.abs(up), up > np.abs(right), up < -np.abs(right)):
        assert np.count_nonzero(quarter) == pytest.approx(expected / 4, abs=5 * math.sqrt(expected / 4))
    inner = np.count_nonzero(np.hypot(right, up) < DEG)
    assert inner == pytest.approx(expected / 4, abs=5 * math.sqrt(expected / 4))


def test_the_bright_end_of_the_synthetic_sky_is_at_4_mag() -> None:
    """Of 300 square degrees with nine stars to 7 mag and none with a name."""
    found = SyntheticSky().near(0.2, -0.05, 10 * DEG)
    bright = np.sort(found.magnitude)
    assert bright[0] >= 4.0 and np.count_nonzero(bright < 7) == pytest.approx(
        314 * 7.9 * 10 ** (-3 * 0.43), abs=5 * math.sqrt(127)
    )


def test_two_fields_that_overlap_have_the_same_stars() -> None:
    whole = SyntheticSky().near(1.0, 0.5, 2 * DEG)
    part = SyntheticSky().near(1.01, 0.505, 1 * DEG)
    again = whole.near(1.01, 0.505, 1 * DEG)
    assert np.array_equal(np.sort(part.magnitude), np.sort(again.magnitude))


def test_a_star_is_seen_where_its_track_is() -> None:
    """`observe` takes each star by itself, with ERFA's other function."""
    for name in ("Pollux", "Sirius", "Arcturus"):
        star = STARS[name]
        alone = SyntheticSky().near(star.right_ascension_rad, star.declination_rad, 1e-6)
        h, d = observed(alone, NAINITAL, CLOCK, 50.0)
        seen = observe(star, NAINITAL, CLOCK, 50.0)
        assert math.remainder(float(h[0]) - seen.hour_angle_rad, 2 * math.pi) == pytest.approx(0, abs=1e-9)
        assert float(d[0]) == pytest.approx(seen.declination_rad, abs=1e-9)


def test_the_catalogued_place_is_seen_where_the_telescope_looks() -> None:
    look = Look(3_000_000_000, -0.3, 0.4)
    ra, dec = catalogued(look, NAINITAL, CLOCK)
    h, d = observed(stars([ra], [dec], [1.0]), NAINITAL, CLOCK, 3.0)
    assert (float(h[0]), float(d[0])) == pytest.approx((-0.3, 0.4), abs=1e-8)


def test_a_plane_is_that_of_lines_through_the_sphere() -> None:
    """Unit vectors: the plane's coordinates are components over that along the axis."""
    look = Look(0, 0.3, 0.7, 0.25)

    def vector(h: float, d: float) -> np.ndarray:
        return np.array([math.cos(d) * math.cos(h), math.cos(d) * math.sin(h), math.sin(d)])

    axis = vector(0.3, 0.7)
    west = np.array([-math.sin(0.3), math.cos(0.3), 0.0])
    north = np.cross(axis, west)
    for h, d in ((0.31, 0.68), (0.5, 0.9), (-0.2, 0.1)):
        star = vector(h, d) / (vector(h, d) @ axis)
        right = (west * math.cos(0.25) - north * math.sin(0.25)) @ star
        up = (west * math.sin(0.25) + north * math.cos(0.25)) @ star
        found = plane(np.array([h]), np.array([d]), look)
        assert [float(each[0]) for each in found] == pytest.approx([right, up])


@pytest.mark.parametrize(("away_deg", "seen"), [(83.0, True), (85.0, False), (170.0, False)])
def test_what_is_beside_or_behind_the_telescope_has_no_place(away_deg: float, seen: bool) -> None:
    right, up = plane(np.array([away_deg * DEG]), np.array([0.0]), Look(0, 0.0, 0.0))
    assert bool(np.isfinite(right[0])) == bool(np.isfinite(up[0])) == seen


@pytest.mark.parametrize("roll", [0.0, 0.5, -2.0])
def test_turning_is_a_rotation_from_right_and_up_to_east_and_north(roll: float) -> None:
    """Precession turns the sky by a quarter of a degree at most there, refraction squeezes it by 1e-3."""
    matrix = turning(Look(0, 0.2, 0.6, roll), 1e-4, NAINITAL, CLOCK) * DEG
    c, s = math.cos(roll), math.sin(roll)
    assert matrix == pytest.approx(np.array([[-c, -s], [-s, c]]), abs=6e-3)
