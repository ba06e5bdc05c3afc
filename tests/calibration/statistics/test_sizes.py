"""Sizes with their intervals, and tails, worked out by hand or by scipy.stats."""

from math import exp, isnan, log, log10, sqrt

import numpy as np
import pytest
from scipy import stats

from calibration.statistics.tails import (
    median_reach,
    middle,
    rms,
    rms_interval,
    share_log10,
    variance_log10,
    wald_log10,
)  # fmt: skip

T_2 = 4.302652729911275  # Student's t of two degrees of freedom, 97.5 %; tables
T_1 = 12.706204736432095


def test_an_rms_is_the_root_of_the_mean_square() -> None:
    assert rms(np.array([3.0, -4.0])) == pytest.approx(sqrt(12.5)) and isnan(rms(np.zeros(0)))


def test_an_rms_interval_is_of_its_blocks_mean_squares() -> None:
    """Three blocks of two rows: mean squares 1, 4 and 7, whose standard deviation is 3."""
    e = np.array([1.0, -1.0, 2.0, 2.0, sqrt(7), -sqrt(7)])
    size, low, high = rms_interval(e, 2)
    reach = T_2 * 3.0 / sqrt(3) / (2 * 2.0)
    assert (size, low, high) == pytest.approx((2.0, max(2.0 - reach, 0.0), 2.0 + reach))
    far = rms_interval(np.array([10.0, 10.0, 10.4, 10.4, 10.2, 10.2]), 2)
    squares = np.array([100.0, 108.16, 104.04])
    reach = T_2 * squares.std(ddof=1) / sqrt(3) / (2 * sqrt(squares.mean()))
    assert far == pytest.approx(
        (sqrt(squares.mean()), sqrt(squares.mean()) - reach, sqrt(squares.mean()) + reach)
    )
    two = rms_interval(np.array([1.0, 1.0, 3.0]), 2)  # the last block is shorter: mean squares 1 and 9
    assert two[2] - two[0] == pytest.approx(T_1 * sqrt(32) / sqrt(2) / (2 * sqrt(11 / 3)))


def test_one_block_leaves_an_rms_open() -> None:
    assert rms_interval(np.array([2.0, -2.0]), 5) == pytest.approx((2.0, 0.0, 2.0 + 2.0 * T_1))
    assert rms_interval(np.zeros(4), 2) == (0.0, 0.0, 0.0)
    assert rms_interval(np.full(4, 1e-3), 2) == pytest.approx((1e-3, 1e-3, 1e-3))


def test_a_median_reaches_by_a_quarter_more_than_a_mean() -> None:
    x = np.array([1.0, 2.0, 6.0])
    reach = T_2 * 1.25 * sqrt(7.0) / sqrt(3.0)
    assert median_reach(x) == pytest.approx(reach)
    found = middle(x, "deg")
    assert (found.value, found.unit) == (2.0, "deg")
    assert [found.low, found.high] == pytest.approx([2.0 - reach, 2.0 + reach])
    two = middle(np.array([1.0, 3.0]), "m")
    assert two.half == pytest.approx(T_1 * 1.25 * sqrt(2.0) / sqrt(2.0))
    one = middle(np.array([5.0]), "m")
    assert (one.value, one.low, one.high) == (5.0, None, None)


def test_bounds_of_chance_are_chernoffs() -> None:
    assert variance_log10(3.0, 20.0) == pytest.approx(10.0 * (2.0 - log(3.0)) / log(10.0))
    assert variance_log10(1.5, 4.0) == pytest.approx(2.0 * (0.5 - log(1.5)) / log(10.0))
    assert variance_log10(1.0, 20.0) == variance_log10(0.5, 20.0) == 0.0
    assert share_log10(5.0, 5.0, 0.1) == pytest.approx(5.0)  # five in a row, each of one in ten
    half = 0.5 * log10(0.5 / 0.2) + 0.5 * log10(0.5 / 0.8)
    assert share_log10(10.0, 20.0, 0.2) == pytest.approx(20 * half)
    assert share_log10(4.0, 20.0, 0.2) == share_log10(1.0, 20.0, 0.2) == share_log10(0.0, 0.0, 0.2) == 0.0
    assert share_log10(0.5, 0.5, 0.2) == pytest.approx(
        0.5 * (0.5 * log10(0.5 / 0.2) + 0.5 * log10(0.5 / 0.8))
    )


@pytest.mark.parametrize(("wald", "width", "blocks"), [(3.0, 1, 20), (40.0, 4, 21), (7.0, 2, 3), (5.0, 1, 2)])
def test_a_wald_statistic_over_its_width_is_an_f(wald: float, width: int, blocks: int) -> None:
    exact = -stats.f.logsf(wald / width, width, blocks - 1) / log(10)
    assert float(wald_log10(wald, width, blocks)) == pytest.approx(exact, rel=1e-9)
    assert float(wald_log10(wald, width, 0.5)) == pytest.approx(float(wald_log10(wald, width, 2.0)))


@pytest.mark.parametrize(("width", "blocks"), [(2, 401), (4, 801)])
def test_a_tail_that_no_double_holds_is_its_leading_term(width: int, blocks: int) -> None:
    """On either side of a tail of 1e-250 the evidence goes on; of two coefficients the tail is a power."""
    a, found = (blocks - 1) / 2, []
    for tail in (240, 249, 251, 260, 400, 1000):
        part = exp(-tail * log(10) / a)
        wald = 2 * a * (1 / part - 1)
        found.append(float(wald_log10(wald, width, blocks)))
        if width == 2:
            assert found[-1] == pytest.approx(tail, rel=1e-6 if tail < 250 else 1e-3)
    slopes = np.diff(found) / np.diff([240, 249, 251, 260, 400, 1000])
    assert np.all(np.diff(found) > 0) and slopes == pytest.approx(np.ones(5), abs=0.02)
