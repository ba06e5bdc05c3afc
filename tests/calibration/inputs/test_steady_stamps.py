"""Stamps that shake while the samples are even: how much, by what it shows, and where rows are missing."""

from math import inf, nan

import numpy as np
import pytest

from calibration.inputs.rows import _bends, _digits, _places, _quick, jumps_of_clock, steady_stamps
from calibration.inputs.run import Run
from tests.calibration.inputs.made import PERIOD_S, run

ROWS = 800
EVEN = "the samples were taken evenly: rows are put on an even grid"


def shaken(size: float, follows: float = 0.0, rows: int = ROWS, start: float = 0.0) -> Run:
    """Stamps off by `size` s one way and the other; the drive moves with the share `follows` of that."""
    k = np.arange(rows)
    off = size * np.where(k % 2, 1.0, -1.0)
    at = PERIOD_S * k + follows * off
    return run(300.0 * at + at**2, start + PERIOD_S * k + off)


@pytest.mark.parametrize(
    ("given", "ms"),
    [
        (shaken(0.001), "1"),
        (shaken(0.0012345), "1.23"),
        (shaken(0.00021), "0.21"),
        (shaken(0.0049), "4.9"),
        (shaken(0.001, 0.41), "1"),
        (shaken(0.001, start=5.0), "1"),
        (shaken(0.001, rows=607), "1"),
    ],
)
def test_rows_are_put_on_an_even_grid(given: Run, ms: str) -> None:
    size = float(np.std(given.columns["t"] - PERIOD_S * np.arange(given.rows)))
    steady_stamps(given)
    assert given.columns["t"] == pytest.approx(PERIOD_S * np.arange(given.rows), abs=size / 20)
    assert given.columns["t"][0] == 0.0 and given.period_s == pytest.approx(PERIOD_S, rel=1e-3)
    (found,) = given.repairs
    assert (found.kind, found.channel, found.rows) == ("jitter", "time", given.rows)
    assert found.size == pytest.approx(size, rel=1e-3)
    assert found.note == f"time stamps shake by {ms} ms rms, {EVEN}"


@pytest.mark.parametrize(
    "given",
    [
        shaken(0.00019),  # a fiftieth of a period changes nothing
        shaken(0.0051),  # half a period is a clock that wanders
        shaken(0.001, 0.42),  # 0.42 / 0.58, squared, is more than half
        shaken(0.001, 1.0),
        shaken(0.001, rows=606),  # a third of the rows are too few
        shaken(0.001, rows=2),
    ],
)
def test_stamps_stay_that_shake_too_little_too_much_or_as_the_drive_does(given: Run) -> None:
    before = given.columns["t"].copy()
    steady_stamps(given)
    assert given.columns["t"].tolist() == before.tolist() and not given.repairs


def test_stamps_of_few_digits_are_rounded_and_not_shaken() -> None:
    k = np.arange(ROWS)
    r = run(300.0 * k + 0.01 * k**2, np.round(0.0128 * k, 2))
    r.period_s = 0.0128
    steady_stamps(r)
    (found,) = r.repairs
    assert found.kind == "rounded" and ", their own step: rows are put" in found.note
    assert found.size == pytest.approx(0.01 / np.sqrt(12), rel=0.05)
    assert r.columns["t"] == pytest.approx(0.0128 * k, abs=1e-3) and r.period_s == pytest.approx(
        0.0128, rel=1e-4
    )
    r = run(300.0 * k + 0.01 * k**2, 0.02 * k + 0.01 * (k % 2))  # 5 ms rms: rounding to 10 ms leaves 2.9
    r.period_s = 0.02
    steady_stamps(r)
    assert r.repairs[0].kind == "jitter"


@pytest.mark.parametrize(
    ("steps", "places"),
    [
        ([1.0, 1.0, 3.0, 1.0], [0, 1, 2, 5, 6]),
        ([1.0, 2.0, 1.0, 1.0], [0, 1, 3, 4, 5]),
        ([1.0, 2.0, 0.0, 1.0], [0, 1, 2, 3, 4]),  # late once
        ([1.0, 0.0, 2.0, 1.0], [0, 1, 2, 3, 4]),
        ([0.0, 2.0, 1.0, 1.0], [0, 1, 2, 3, 4]),
        ([1.5, 1.5, 1.5, 1.5], [0, 1, 2, 3, 4]),
        ([1.0, 1.7, 1.0, 1.0], [0, 1, 3, 4, 5]),  # 2.7 of two rows together
        ([1.0, 1.7, 0.8, 1.0], [0, 1, 2, 3, 4]),  # 2.5 together
        ([2.0, 1.0, 1.0, 2.0], [0, 2, 3, 4, 6]),
        ([2.0, 0.5, 0.5, 2.0], [0, 1, 2, 3, 4]),
    ],
)
def test_a_row_is_one_on_from_the_row_before_but_where_rows_are_missing(
    steps: list[float], places: list[int]
) -> None:
    t = 7.0 + PERIOD_S * np.concatenate([[0.0], np.cumsum(steps)])
    assert _places(t, PERIOD_S).tolist() == places


@pytest.mark.parametrize(
    ("t", "step"),
    [
        ([3, 5], 1.0),
        ([0.1, 0.3], 0.1),
        ([0.25, 0.5], 0.01),
        ([0.125003, 1], 1e-6),
        ([0.12345675], 0.0),
        ([0.1234567], 0.0),
    ],
)
def test_the_digits_of_a_clock_are_a_power_of_ten(t: list[float], step: float) -> None:
    assert _digits(np.array(t)) == pytest.approx(step)


def test_a_bend_is_what_the_line_between_the_neighbours_leaves() -> None:
    found = _bends(np.array([1.0, 2.0, 4.0, 5.0]), np.array([1.0, 6.0, 10.0, 11.0]))
    assert found[1:3] == pytest.approx([6 - 4, 10 - (6 + 5 * 2 / 3)]) and np.isnan(found[[0, 3]]).all()
    assert _bends(np.zeros(3), np.array([0.0, 5.0, 0.0]))[1] == 5.0  # three rows of one stamp


def test_the_quick_rows_have_both_neighbours_and_are_a_third() -> None:
    place = np.array([0, 1, 2, 3, 4, 6, 7, 8, 9, 10, 11.0])
    x = np.cumsum([0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10.0])  # speeds 1.5, 2.5, 3.5, then from row 6 on 6.5 ...
    # rows 4 and 5 lie at a gap: of 1 to 3 and 6 to 9, the quickest third are 8 and 9
    assert np.flatnonzero(_quick(place, x)).tolist() == [8, 9]
    x[10] = nan
    assert np.flatnonzero(_quick(place, x)).tolist() == [7, 8]
    x[10], x[8] = 55.0, nan
    assert np.flatnonzero(_quick(place, x)).tolist() == [6]
    assert not _quick(2 * place, x).any()


@pytest.mark.parametrize(
    ("at", "count", "moved", "told"),
    [
        (12, 3, 1.0, True),
        (12, 3, 3.0, False),
        (12, 3, 1.9, True),
        (12, 3, 2.0, False),
        (12, 1, 1.0, False),  # no step at all
        (1, 3, 1.0, True),
        (0, 3, 1.0, False),  # ten rows beside it are too few
        (28, 3, 1.0, True),
        (29, 3, 1.0, False),
        (12, 2, 1.4, True),
    ],
)
def test_a_step_of_the_clock_alone_is_told_by_the_rows_beside_it(
    at: int, count: int, moved: float, told: bool
) -> None:
    travel, steps = np.ones(30), np.ones(30, dtype=np.int64)
    travel[at], steps[at] = moved, count
    for way in (1.0, -1.0):
        found = jumps_of_clock(way * np.concatenate([[0.0], np.cumsum(travel)]), steps)
        assert np.flatnonzero(found).tolist() == [at] * told


def test_a_step_beside_rest_a_turn_or_rows_without_a_number_tells_nothing() -> None:
    steps = np.ones(30, dtype=np.int64)
    steps[12] = 3
    for k, other in ((14, 0.0), (3, -1.0), (22, -1.0)):
        travel = np.ones(30)
        travel[k] = other
        assert not jumps_of_clock(np.concatenate([[0.0], np.cumsum(travel)]), steps).any(), k
    for k in (1, 23):  # eleven rows away it turns, if it likes
        travel = np.ones(30)
        travel[k] = -5.0
        assert jumps_of_clock(np.concatenate([[0.0], np.cumsum(travel)]), steps)[12], k
    x = np.arange(31.0)
    x[13:] -= 2.0
    x[[4, 20]] = inf, nan
    assert jumps_of_clock(x, steps)[12]
    every_other = np.where(np.arange(30) == 12, 3, np.arange(30) % 2 + 1)
    travel = np.where(np.arange(30) == 12, 2.0, every_other)  # two rows' motion is neither one's nor three's
    assert not jumps_of_clock(np.concatenate([[0.0], np.cumsum(travel)]), every_other).any()
    steps[9] = 2  # of two steps near, the other's rows count by the period
    x = np.concatenate([[0.0], np.cumsum(np.where(np.arange(30) == 9, 2.0, 1.0))])
    assert np.flatnonzero(jumps_of_clock(x, steps)).tolist() == [12]
