"""White noise and its bends behind a filter, by the filter's own weights; stretches of rows."""

from typing import Any

import numpy as np
import pytest

from calibration.balances.filters import Filter, boxcar, by_piece, pieces, since, smooth

ROWS = 401
ONE = np.zeros(ROWS, dtype=np.int64)


def answer(low_pass: Filter) -> np.ndarray:
    """What is left of one row of 1."""
    full = np.zeros(ROWS)
    full[ROWS // 2] = 1.0
    return low_pass(full, ONE)


@pytest.mark.parametrize("low_pass", [Filter(2.0), Filter(5.0), Filter(1.0, 3), Filter(1.0, 9)])
def test_white_noise_behind_a_filter_is_the_square_of_its_weights(low_pass: Filter) -> None:
    weights = answer(low_pass)
    assert low_pass.passes == pytest.approx(np.sum(weights**2), rel=1e-3)
    assert weights.sum() == pytest.approx(1.0)


@pytest.mark.parametrize("sigma", [3.0, 6.0])
def test_its_second_difference_is_that_of_the_weights(sigma: float) -> None:
    bent = np.diff(answer(Filter(sigma)), 2)
    assert Filter(sigma).bends == pytest.approx(np.sum(bent**2), rel=0.25 / sigma)


@pytest.mark.parametrize("width", [3, 9])
def test_of_boxcars_a_second_difference_is_of_means_as_many_rows_apart(width: int) -> None:
    """One, minus two and one of three means, over the square of their distance."""
    assert Filter(1.0, width).bends == pytest.approx((1 + 4 + 1) / width**4)
    weights = answer(Filter(1.0, width))
    assert Filter(1.0, width).weights == pytest.approx(weights[ROWS // 2 - width + 1 : ROWS // 2 + width])


def test_a_filter_of_less_than_a_row_leaves_as_much_as_one_of_a_row() -> None:
    assert Filter(0.5).passes == Filter(1.0).passes == pytest.approx(1 / (2 * np.sqrt(np.pi)))
    assert Filter(0.5).bends == Filter(1.0).bends == pytest.approx(3 / (8 * np.sqrt(np.pi)))
    assert Filter(0.0).passes == 1.0 and Filter(2.0).bends == pytest.approx(Filter(1.0).bends / 32)


def test_stretches_of_equal_labels() -> None:
    assert pieces(np.array([3, 3, 1, 1, 1, 3])) == [(0, 2), (2, 5), (5, 6)]
    assert pieces(np.array([], dtype=np.int64)) == [] and pieces(np.array([7])) == [(0, 1)]


def test_rows_since_the_last_mark() -> None:
    mark = np.array([False, False, True, False, True, False, False])
    assert since(mark)[2:].tolist() == [0, 1, 0, 1, 2] and since(mark)[0] == 10**9
    assert since(mark, 5).tolist() == [5, 6, 0, 1, 0, 1, 2]


@pytest.mark.parametrize(("least", "expected"), [(1, [2, 4, 6, 8, 10]), (2, [2, 4, 0, 8, 10]), (3, [0] * 5)])
def test_a_stretch_that_is_too_short_has_nothing(least: int, expected: list[int]) -> None:
    label = np.array([0, 0, 1, 2, 2])
    found: Any = by_piece(np.arange(1.0, 6.0), label, lambda x: 2 * x, least)
    assert found.tolist() == expected


def test_means_stay_within_their_stretch_and_repeat_its_ends() -> None:
    x = np.array([1.0, 1.0, 1.0, 9.0, 9.0, 9.0])
    label = np.repeat([0, 1], 3)
    assert smooth(x, label, 2.0) == pytest.approx(x) and smooth(x, label, 0.0) is x
    assert boxcar(x, 1) is x and boxcar(x, 0) is x
    assert boxcar(np.array([0.0, 3.0, 6.0, 0.0]), 3) == pytest.approx([1.0, 3.0, 3.0, 2.0])
    two = np.column_stack([x, 2 * x])
    assert smooth(two, label, 1.0) == pytest.approx(two) and smooth(x, 0 * label, 1.0)[2] > 1.1
