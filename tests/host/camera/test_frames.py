"""Frames: stars in their places, trails, focus, saturation, files. No device is in between."""

import datetime as dt
from pathlib import Path

import numpy as np
import pytest

from bus.time import generator
from host.camera.camera import Frame, Order, expose
from host.camera.light import light
from host.camera.models import GUIDE, MAIN, CameraModel, Look, Window
from host.camera.seeing import Wander
from host.camera.stars import SyntheticSky, stars
from host.sky.catalogue import STARS
from host.sky.observed import Clock, observe
from host.sky.site import NAINITAL

CLOCK = Clock(dt.datetime(2026, 2, 10, 14, 0, tzinfo=dt.UTC))
SIDEREAL_RAD_S = 7.2921159e-5
START_S = 100.0


def path(seconds: float, west_rad_s: float = 0.0, focus_m: float = 0.0) -> list[Look]:
    looks = []
    for k in range(int(seconds * 100) + 1):
        t_s = START_S + k * 0.01
        place = observe(STARS["Pollux"], NAINITAL, CLOCK, t_s)
        hour_angle_rad = place.hour_angle_rad + west_rad_s * k * 0.01
        looks.append(Look(round(t_s * 1e9), hour_angle_rad, place.declination_rad, 0.0, focus_m))
    return looks


def frame(
    seconds: float, west_rad_s: float = 0.0, focus_m: float = 0.0, seed: int = 1, model: CameraModel = GUIDE,
    size: int = 201,
) -> Frame:  # fmt: skip
    """Pollux in the middle of a window; the telescope drifts west of it. Roll is nought."""
    looks = path(seconds, west_rad_s, focus_m)
    left, top = (model.width - size) // 2, (model.height - size) // 2
    order = Order(seconds=seconds, window=Window(left=left, top=top, width=size, height=size))
    wander = Wander(model.aperture_m, seed, model.name)
    random = generator(seed, "test")
    return expose(model, order, tuple(looks), SyntheticSky(), NAINITAL, CLOCK, wander, random)


def middle(one: Frame) -> tuple[float, float, float, float]:
    """Of what is bright, the named star alone: column, row, their standard deviations, px."""
    light = one.counts.astype(float) - np.median(one.counts)
    light[light < 0.1 * light.max()] = 0.0
    rows, columns = np.indices(light.shape)
    x, y = (np.average(each, weights=light) for each in (columns, rows))
    spread = (np.sqrt(np.average((each - at) ** 2, weights=light)) for each, at in ((columns, x), (rows, y)))
    return float(x), float(y), *map(float, spread)  # type: ignore[return-value]


def test_a_star_that_is_followed_stands_where_the_telescope_looks() -> None:
    x, y, across, down = middle(frame(2.0))
    assert (x, y) == pytest.approx((100, 100), abs=0.6)  # seeing moves it by less than a pixel
    assert across < 2.5 and down < 2.5


def test_who_does_not_follow_draws_a_trail_of_the_right_length() -> None:
    drift_rad_s = 20 * GUIDE.pixel_rad / 2.0  # of hour angle; the star is at 28 degrees of declination
    _, _, across, down = middle(frame(2.0, west_rad_s=drift_rad_s))
    length = 20 * np.cos(STARS["Pollux"].declination_rad)
    assert across == pytest.approx(length / np.sqrt(12), rel=0.15) and down < 2.5


def test_out_of_focus_a_star_is_a_disc_of_the_cone() -> None:
    away_m = 40 * MAIN.pixel_m  # at f/1 the cone is as wide as it is long
    _, _, across, down = middle(frame(0.3, focus_m=away_m, model=MAIN))  # no well is full
    assert (across, down) == pytest.approx((10.0, 10.0), rel=0.1)  # an even disc: a quarter of its diameter


def test_a_bright_star_ends_at_the_full_well() -> None:
    one = frame(5.0, model=MAIN, size=61)
    top = min(MAIN.full_well_e / MAIN.gain_e_adu + MAIN.offset_adu, MAIN.most_adu)
    assert top - 200 < one.counts.max() <= min(top + 200, MAIN.most_adu)


def test_a_window_is_a_part_of_the_whole_frame() -> None:
    def seen(window: Window) -> np.ndarray:
        wander = Wander(GUIDE.aperture_m, 1, GUIDE.name)
        return light(GUIDE, path(0.5), window, SyntheticSky(), NAINITAL, CLOCK, wander)

    whole = seen(Window(left=0, top=0, width=GUIDE.width, height=GUIDE.height))
    part = seen(Window(left=1000, top=20, width=280, height=150))
    assert np.allclose(part, whole[20:170, 1000:], atol=1e-6)
    assert part.max() > 2 * np.median(part)  # there is a star in it


def test_a_sky_without_a_star_there_is_dark() -> None:
    far = stars([0.0], [-1.5], [5.0])
    window = Window(left=0, top=0, width=40, height=30)
    image = light(GUIDE, path(0.5), window, far, NAINITAL, CLOCK, Wander(GUIDE.aperture_m, 1, GUIDE.name))
    assert image.shape == (30, 40) and np.ptp(image) < 1e-5 * image.mean()


def test_the_same_seed_is_the_same_frame() -> None:
    one, again, other = frame(0.5), frame(0.5), frame(0.5, seed=2)
    assert np.array_equal(one.counts, again.counts) and not np.array_equal(one.counts, other.counts)


def test_astropy_finds_the_star_by_the_files_own_coordinates(tmp_path: Path) -> None:
    fits = pytest.importorskip("astropy.io.fits", reason="astropy is not installed: pip install .[camera]")
    from astropy.wcs import WCS

    from host.camera.fits import write

    one = frame(2.0)
    with fits.open(write(one, NAINITAL, CLOCK, tmp_path)) as found:
        star = STARS["Pollux"]
        sky = WCS(found[0].header)
        years, degrees = 26.1, 1 / 3_600_000  # proper motion since J2000.0, from milliarcseconds
        dec = np.degrees(star.declination_rad) + star.pm_dec_mas_yr * years * degrees
        ra_motion = star.pm_ra_mas_yr * years * degrees / np.cos(star.declination_rad)
        ra = np.degrees(star.right_ascension_rad) + ra_motion
        x, y = sky.all_world2pix(ra, dec, 0)
        assert np.array_equal(found[0].data, one.counts)
    assert (float(x), float(y)) == pytest.approx((100, 100), abs=0.6)
