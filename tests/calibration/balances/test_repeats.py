"""Motion that repeats itself in time or stroke by stroke, and how much repeats differ."""

from typing import Any

import numpy as np
import pytest

from calibration.balances.repeats import _difference, repeat_lag, stroke_scatter
from calibration.balances.view import View
from tests.calibration.names.made import back_and_forth, drive


def sine(period: float, rows: int = 2000) -> np.ndarray:
    return np.asarray(np.sin(2 * np.pi * np.arange(rows) / period))


def lag(x: np.ndarray, **more: Any) -> int:
    return repeat_lag(drive(x, **more).view)


@pytest.mark.parametrize("period", [100, 400, 1200])
def test_a_motion_repeats_itself_after_its_period(period: int) -> None:
    assert lag(7.0 + sine(period)) == period


def test_a_period_of_more_than_two_thirds_of_the_log_is_none_and_so_is_a_straight_way() -> None:
    assert lag(sine(1600)) == 0
    assert lag(np.arange(2000.0)) == 0 and lag(np.ones(2000)) == 0
    assert lag(np.random.default_rng(1).standard_normal(2000)) == 0


def test_less_than_a_hundred_rows_repeat_nothing() -> None:
    assert lag(sine(20, 100)) == 20 and lag(sine(20, 99)) == 0


def test_the_reference_and_the_longest_file_tell() -> None:
    assert lag(sine(400), columns={"reference": sine(300)}) == 300
    both = np.concatenate([sine(100, 900), sine(400)])
    assert lag(both, files=np.repeat([0, 1], [900, 2000])) == 400


def test_a_long_log_is_thinned() -> None:
    assert lag(sine(4000, 40_000)) == 4000 and lag(sine(4002, 60_000)) == 4002


@pytest.mark.parametrize(("size", "expected"), [(0.05, 400), (0.1, 800), (0.3, 800)])
def test_the_first_lag_that_is_all_but_as_good_is_taken(size: float, expected: int) -> None:
    """Strokes that alternate by 0.05 repeat with (1 - s2) / (1 + s2) = 0.995 at once, by 0.1 with 0.98."""
    assert lag(sine(400, 4000) + size * sine(800, 4000)) == expected


@pytest.mark.parametrize(("share", "expected"), [(0.04, 400), (0.12, 0)])
def test_a_repeat_has_more_than_93_hundredths_of_the_motion(share: float, expected: int) -> None:
    """Of noise with a share s of the motion's power is left 1 / (1 + s)."""
    noise = np.sqrt(0.5 * share) * np.random.default_rng(2).standard_normal(20_000)
    found = lag(sine(400, 20_000) + noise)
    assert found % 400 in (0, 1, 399) and (found > 0) == (expected > 0)


def strokes(count: int, rows: int = 100) -> tuple[View, np.ndarray]:
    """Strokes, and a number (n,) that hangs on the place and grows by 0.1 from stroke to stroke."""
    x = back_and_forth(count, rows, 200.0)
    return drive(x).view, np.sin(x / 20.0) + 0.1 * (np.arange(len(x)) // rows)


@pytest.mark.parametrize(("count", "told"), [(5, False), (6, True), (9, True)])
def test_four_pairs_of_strokes_the_same_way_have_a_scatter(count: int, told: bool) -> None:
    found = stroke_scatter(*strokes(count))
    assert (found is not None) == told
    assert not told or found == pytest.approx(0.2 / np.sqrt(2), rel=0.02)


@pytest.mark.parametrize(("rows", "told"), [(40, False), (80, True)])
def test_pairs_hold_two_hundred_rows(rows: int, told: bool) -> None:
    assert (stroke_scatter(*strokes(6, rows)) is not None) == told


def test_wobbles_and_rests_are_no_strokes() -> None:
    """Of 0.2 travels between the strokes; those of 0.4 stand between two of the same ends."""

    def wobbling(part: float) -> float | None:
        one = np.arange(100.0) / 100
        there = np.concatenate([one, 1 - part * one, 1 - part + part * one, np.ones(100), 1 - one])
        x = 200.0 * np.tile(there, 4)
        e = np.where(np.isin(np.arange(len(x)) // 100 % 5, (0, 4)), 1.0, 0.0) * (np.arange(len(x)) // 500.0)
        return stroke_scatter(drive(x).view, e)

    alone, both = wobbling(0.2), wobbling(0.4)
    assert alone == pytest.approx(1 / np.sqrt(2), rel=0.02) and both is None


def test_strokes_of_two_files_are_not_one() -> None:
    x = np.tile(np.arange(100.0), 6)
    files = np.repeat(np.arange(6), 100)
    found = stroke_scatter(drive(x, files=files).view, files.astype(float))
    assert found == pytest.approx(1 / np.sqrt(2))


def pair(ends: float = 0.0, lasts: float = 1.0, way: float = 1.0) -> int | None:
    """Rows that two strokes over 200 places have in common: the second goes further, for another time."""
    x = way * np.concatenate([np.arange(201.0), np.linspace(ends, 200.0 + ends, 201)])
    t = np.concatenate([np.arange(201.0), 1000.0 + lasts * np.arange(201.0)])
    found = _difference(x, t, np.abs(x) * np.repeat([1.0, 3.0], 201), (0, 201), (201, 402))
    if found is None:
        return None
    inner = np.linspace(ends, 200.0 + ends, 201)
    inner = inner[(inner > 4.0) & (inner < 196.0)]
    assert found == pytest.approx(2 * inner)
    return len(found)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_strokes_are_compared_place_by_place_but_for_their_ends(way: float) -> None:
    assert pair(way=way) == 191  # 5 to 195
    assert pair(ends=5.5, way=way) == 191
    assert pair(ends=-5.5, way=way) == 191


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_stroke_to_other_ends_or_of_another_time_is_another_motion(sign: float) -> None:
    assert pair(ends=sign * 5.9) is not None and pair(ends=sign * 6.1) is None
    assert pair(lasts=1 + sign * 0.049) is not None and pair(lasts=1 + sign * 0.051) is None


def test_rows_without_a_number_are_left_out_and_noise_may_go_back() -> None:
    x = np.tile(np.arange(101.0), 2)
    x[50] = 48.0
    e = np.where(np.arange(202) < 101, 0.0, 1.0)
    e[130:140] = np.nan
    found = _difference(x, np.tile(np.arange(101.0), 2), e, (0, 101), (101, 202))
    assert found is not None and len(found) == 95 - 10 and found == pytest.approx(1.0)
