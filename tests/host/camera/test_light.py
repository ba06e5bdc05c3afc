"""Light on a detector without seeing: by hand how much, and by normal distributions where."""

import math

import numpy as np
import pytest
from scipy.signal import convolve2d

from bus.units import ARCSEC
from host.camera import light as module
from host.camera.models import GUIDE, MAIN, Look, Window
from host.camera.stars import Array, Stars, SyntheticSky, observed, plane, stars
from host.sky.site import NAINITAL
from tests.host.camera.still import POLLUX, Still, bell, drawn, middle, pollux
from tests.host.camera.test_frames import CLOCK, START_S, path

SECONDS = 0.2
ZERO_POINT = 8.8e9 * 0.4 * math.pi * 0.08**2 / 4
"""Of the guide camera: photons, throughput and aperture of the table."""
PIXEL = 3.75e-6 / 0.4
SIGMA_PX = math.sqrt(0.1) * ARCSEC / PIXEL
"""Its images are as narrow as they may be: the wander alone is nearly two arcseconds wide."""
DARK = stars([0.0], [-1.5], [5.0])


def test_the_sky_alone_is_21_magnitudes_per_square_arcsecond() -> None:
    image = drawn(GUIDE, path(SECONDS), DARK, middle(GUIDE, 2))
    assert image == pytest.approx(ZERO_POINT * 10**-8.4 * (PIXEL / ARCSEC) ** 2 * SECONDS, rel=1e-6)


def test_a_pixel_in_a_corner_sees_less_sky_by_the_cube_of_the_cosine() -> None:
    corner, centre = (
        drawn(MAIN, path(SECONDS), DARK, window)[0, 0]
        for window in (Window(left=0, top=0, width=1, height=1), middle(MAIN, 2))
    )
    away = math.hypot(2047.5, 2047.5) * 9e-6 / 0.5
    assert corner / centre == pytest.approx((1 + away**2) ** -1.5, rel=1e-6)


def test_a_star_is_a_gaussian_that_holds_all_its_light() -> None:
    window = middle(GUIDE, 12)
    image = drawn(GUIDE, path(SECONDS), pollux(8.0), window) - drawn(GUIDE, path(SECONDS), DARK, window)
    total = ZERO_POINT * 10**-3.2 * SECONDS
    assert image.sum() == pytest.approx(total, rel=1e-5)
    row = bell(12, 5.5, SIGMA_PX)
    assert image == pytest.approx(total * np.outer(row, row), abs=0.01 * total)


def trail(px_s: float, seconds: float, magnitude: float, size: int = 40) -> Array:
    """A telescope that runs west of Pollux by so many pixels a second."""
    west = px_s * PIXEL / math.cos(POLLUX.declination_rad)
    looks = [look._replace(hour_angle_rad=look.hour_angle_rad) for look in path(seconds, west_rad_s=west)]
    window = middle(GUIDE, size)
    return drawn(GUIDE, looks, pollux(magnitude), window) - drawn(GUIDE, path(seconds), DARK, window)


def test_a_trail_has_the_same_light_in_every_pixel_of_its_way() -> None:
    """West is right: the star falls behind to the left of the middle."""
    columns = trail(20.0, 0.8, 8.0).sum(axis=0) / (ZERO_POINT * 10**-3.2 / 20.0)
    assert columns[5:19] == pytest.approx(1.0, abs=0.12)
    assert columns.sum() == pytest.approx(16.0, rel=1e-4)
    assert columns[19] == pytest.approx(1.0, abs=0.2) and columns[20] < 0.1
    assert columns[:3] == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize(("px_s", "seen"), [(100.1, True), (100.9, False)])
def test_beyond_a_hundred_pixels_a_second_the_sky_alone_is_seen(px_s: float, seen: bool) -> None:
    assert bool(trail(px_s, 1.0, 5.0).max() > 1.0) == seen


@pytest.mark.parametrize(("seconds", "px_s"), [(SECONDS, 0.0), (0.4, 10.0)])
def test_a_star_of_half_an_electron_in_a_pixel_of_its_trail_is_left_out(seconds: float, px_s: float) -> None:
    """By hand: its light in that time over the pixels of its way, at least one."""
    faintest = 2.5 * math.log10(ZERO_POINT * seconds / max(px_s * seconds, 1.0) / 0.5)
    assert trail(px_s, seconds, faintest - 0.06).max() > 1e-3
    assert abs(trail(px_s, seconds, faintest + 0.06)).max() < 1e-6


def test_a_star_beside_the_window_reaches_into_it_as_far_as_its_image() -> None:
    window = Window(left=640, top=470, width=20, height=20)  # its left column lies half a pixel off the star
    image = drawn(GUIDE, path(SECONDS), pollux(5.0), window) - drawn(GUIDE, path(SECONDS), DARK, window)
    expected = ZERO_POINT * 10**-2 * SECONDS * np.outer(bell(20, 9.5, SIGMA_PX), bell(20, -0.5, SIGMA_PX))
    assert image == pytest.approx(expected, abs=0.01 * expected.sum())
    below = Window(left=630, top=480, width=20, height=20)
    image = drawn(GUIDE, path(SECONDS), pollux(5.0), below) - drawn(GUIDE, path(SECONDS), DARK, below)
    assert image == pytest.approx(expected.T, abs=0.01 * expected.sum())


def test_out_of_focus_all_light_is_in_the_disc_also_from_beside_the_window() -> None:
    """Ten pixels off at f/1: a disc of five pixels' radius, of which a window has half."""
    looks, total = path(SECONDS, focus_m=10 * MAIN.pixel_m), MAIN.zero_point_e_s * 10**-3.2 * SECONDS
    whole, half = middle(MAIN, 30), Window(left=2048, top=2033, width=15, height=30)
    images = [drawn(MAIN, looks, sky, w) for w in (whole, half) for sky in (pollux(8.0), DARK)]
    seen = images[0] - images[1]
    assert seen.sum() == pytest.approx(total, rel=1e-4)
    assert seen[15, 15] == pytest.approx(total / (math.pi * 25), rel=0.02)
    assert (images[2] - images[3]).sum() == pytest.approx(total / 2, rel=0.01)


def test_a_long_path_has_stars_of_its_own_every_500_pixels() -> None:
    rows = np.zeros((121, 6))
    rows[:, 2] = np.arange(121) * 10 * PIXEL  # north by ten pixels a row
    pieces = [*module._pieces(GUIDE, rows)]
    assert [length for _, length in pieces] == pytest.approx([490, 500, 210])
    assert [len(piece) for piece, _ in pieces] == [50, 50, 21]
    rows[:, 1] = rows[:, 2] * 0.75 / np.cos(rows[:, 2])  # west as well: 12.5 a row
    assert sum(length for _, length in module._pieces(GUIDE, rows)) == pytest.approx(1500, rel=1e-3)


class Asked(SyntheticSky):
    """Keeps what it was asked for."""

    def near(self, right_ascension: float, declination: float, radius: float) -> Stars:
        self.place, self.radius = stars([right_ascension], [declination], [0.0]), radius
        return DARK


@pytest.mark.parametrize("roll", [0.0, 0.4])
def test_stars_are_looked_for_around_the_windows_middle(roll: float) -> None:
    sky, window = Asked(), Window(left=1000, top=100, width=60, height=80)
    look = path(0.0)[0]._replace(roll_rad=roll)
    module._near(GUIDE, look, window, 30.0, sky, NAINITAL, CLOCK)
    assert sky.radius == pytest.approx(1.1 * (50 + 30) * PIXEL + 200 * ARCSEC)
    right, up = plane(*observed(sky.place, NAINITAL, CLOCK, START_S), look)
    assert 639.5 + float(right[0]) / PIXEL == pytest.approx(1029.5, abs=1.0)
    assert 479.5 - float(up[0]) / PIXEL == pytest.approx(139.5, abs=1.0)


def test_a_star_that_has_moved_since_2000_is_in_a_window_of_its_own() -> None:
    """Pollux moved by 16″ until 2026, which is more than eight pixels."""
    image = drawn(GUIDE, path(SECONDS), pollux(8.0), middle(GUIDE, 4))
    assert image.sum() == pytest.approx(ZERO_POINT * 10**-3.2 * SECONDS, rel=0.01)


def test_the_search_ends_at_half_the_sky() -> None:
    sky = Asked()
    module._near(GUIDE, path(0.0)[0], middle(GUIDE, 2), 1e9, sky, NAINITAL, CLOCK)
    assert sky.radius == math.pi / 2


def test_a_path_is_gathered_with_the_time_it_takes() -> None:
    """A telescope at rest for 0.5 s: the sky goes by 15.04″/s, over 1.9337″ to a pixel."""
    looks = [Look(round((100 + 0.05 * k) * 1e9), 0.3, 0.0, 0.2, 1e-3) for k in range(11)]
    found = module._sampled(GUIDE, looks, Still())
    assert found[:, 5].sum() == pytest.approx(0.5)
    assert np.all(np.diff(found[:, 0]) > 0)
    assert found[0, 0] + found[-1, 0] == pytest.approx(200.5, abs=0.07)
    assert found[:, 1] == pytest.approx(0.3) and found[:, 3] == pytest.approx(0.2)
    assert found[:, 4] == pytest.approx(1e-3)
    cells = 0.5 * 15.041 / 1.93373 / 0.25
    assert len(found) == pytest.approx(min(11, cells), abs=1)
    assert found[:, 5].max() <= 3 * 0.5 / 11


def test_a_quick_path_has_two_samples_a_pixel() -> None:
    looks = [Look(k * 10_000_000, 0.0, 20 * k * PIXEL) for k in range(6)]
    found = module._sampled(GUIDE, looks, Still())
    assert len(found) == pytest.approx(200, abs=2)
    assert np.diff(found[:, 2]) == pytest.approx(0.5 * PIXEL, rel=0.02)
    assert found[:, 5] == pytest.approx(0.05 / len(found))


def test_seeing_moves_a_star_against_the_telescope() -> None:
    """To the right and up by an arcsecond: as if the telescope looked to the left and lower."""

    class Off(Still):
        def __call__(self, t_s: Array) -> Array:
            return np.ones((2, len(t_s)))

    looks = [Look(k * 10_000_000, 0.1, 1.0) for k in range(3)]
    still, moved = (module._sampled(GUIDE, looks, each)[0] for each in (Still(), Off()))
    assert moved[1] - still[1] == pytest.approx(-ARCSEC / math.cos(1.0), rel=1e-3)
    assert moved[2] - still[2] == pytest.approx(-ARCSEC, rel=1e-3)


def test_drift_is_against_the_turning_sky() -> None:
    rows = np.array([[10.0, 0.5, 1.0, 0, 0], [20.0, 0.5, 1.25, 0, 0], [20.0, 0.5 + 7.2921159e-4, 1.0, 0, 0]])
    west, north = module._drift(rows)
    assert west == pytest.approx([0.0, -7.2921159e-4 * math.cos(1.25), 0.0], abs=1e-12)
    assert north == pytest.approx([0.0, 0.25, 0.0])


def test_every_star_has_its_pixel_at_every_row_of_a_path() -> None:
    """Rows between the knots, too: against the exact place."""
    looks = path(30.0)[::25]
    rows = np.array([[look.t_ns * 1e-9, *look[1:], 0.5] for look in looks])
    rows[:, 3] = 0.3
    field = SyntheticSky().near(POLLUX.right_ascension_rad, POLLUX.declination_rad, 2e-3)
    assert len(rows) > 24 and len(field.magnitude) > 2
    xs, ys = module._tracks(GUIDE, rows, field, NAINITAL, CLOCK)
    for k in (0, 7, 60, 119, 120):
        look = looks[k]._replace(roll_rad=0.3)
        right, up = plane(*observed(field, NAINITAL, CLOCK, look.t_ns * 1e-9), look)
        assert xs[k] == pytest.approx(639.5 + right / PIXEL, abs=1e-3)
        assert ys[k] == pytest.approx(479.5 - up / PIXEL, abs=1e-3)


@pytest.mark.parametrize("pixels", [40.0, -40.0])
def test_a_disc_out_of_focus_is_even_and_as_wide_as_the_cone(pixels: float) -> None:
    disc = module._disc(MAIN, [Look(0, 0, 0, 0, pixels * MAIN.pixel_m)] * 2)
    assert disc.shape == (41, 41) and disc.sum() == pytest.approx(1.0)
    inside = 1 / (math.pi * 20**2)
    assert disc[20, 20] == pytest.approx(inside, rel=2e-3)
    assert disc[20, 1:40] == pytest.approx(inside, rel=2e-3)
    assert disc[0, 20] == pytest.approx(0.5 * inside, rel=0.1)
    assert disc[3, 3] == 0 and disc == pytest.approx(disc.T) and disc == pytest.approx(disc[::-1, ::-1])


def test_a_small_disc_has_the_areas_of_a_circle() -> None:
    """Of radius one, by integrals: in the middle 1, beside it 0.4566, in the corners the rest of π.

    An eighth of a pixel is coarse: 3 %.
    """
    disc = module._disc(MAIN, [Look(0, 0, 0, 0, 1.2 * MAIN.pixel_m)])
    beside = math.asin(0.5) + 0.5 * math.sqrt(0.75) - 0.5
    corner = (math.pi - 1 - 4 * beside) / 4
    expected = np.array([[corner, beside, corner], [beside, 1, beside], [corner, beside, corner]]) / math.pi
    assert disc == pytest.approx(expected, abs=0.012)


@pytest.mark.parametrize(("pixels", "width"), [(0.98, 1), (1.02, 3), (2.98, 3), (3.02, 5)])
def test_a_disc_begins_where_it_leaves_a_pixel(pixels: float, width: int) -> None:
    assert len(module._disc(MAIN, [Look(0, 0, 0, 0, pixels * MAIN.pixel_m)])) == width


def test_the_guide_camera_has_no_focus() -> None:
    assert module._disc(GUIDE, [Look(0, 0, 0, 0, 1.0)]) == pytest.approx(np.ones((1, 1)))


def test_a_canvas_is_convolved_as_sums_say() -> None:
    numbers = np.arange(9.0 * 11).reshape(9, 11) % 7
    disc = np.arange(9.0).reshape(3, 3)
    assert module._convolved(numbers, disc) == pytest.approx(convolve2d(numbers, disc, "valid"), abs=1e-9)
    assert module._convolved(-numbers, disc).min() == 0.0


def test_stars_are_drawn_each_in_its_place() -> None:
    image = np.zeros((20, 30))
    x, y, electrons = (
        np.array([4.25, 21.0, np.nan]),
        np.array([6.5, 12.75, 3.0]),
        np.array([100.0, 50.0, 9.0]),
    )
    module._draw(image, x, y, electrons, 1.2)
    expected = sum(
        e * np.outer(bell(20, b, 1.2), bell(30, a, 1.2))
        for a, b, e in zip(x[:2], y[:2], electrons[:2], strict=True)
    )
    assert image == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize(
    ("x", "y"), [(-2.0, 5.0), (31.0, 5.0), (5.0, -2.0), (5.0, 21.0), (0.0, 0.0), (29.0, 19.0)]
)
def test_a_star_at_an_edge_leaves_there_what_lies_within(x: float, y: float) -> None:
    image = np.zeros((20, 30))
    module._draw(image, np.array([x]), np.array([y]), np.array([1000.0]), 1.0)
    assert image == pytest.approx(1000 * np.outer(bell(20, y, 1.0), bell(30, x, 1.0)), abs=2e-3)


@pytest.mark.parametrize(("x", "y"), [(-40.0, 5.0), (70.0, 5.0), (5.0, -40.0), (5.0, 60.0), (np.nan, 5.0)])
def test_a_star_far_off_leaves_nothing(x: float, y: float) -> None:
    image = np.zeros((20, 30))
    module._draw(image, np.array([x]), np.array([y]), np.array([1000.0]), 1.0)
    assert not image.any()
