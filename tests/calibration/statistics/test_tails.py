"""Tails and intervals against scipy.stats, and bounds that are bounds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats
from scipy.special import logsumexp

from calibration.statistics.tails import (
    median_reach,
    rms_interval,
    share_log10,
    student_reach,
    variance_log10,
    wald_log10,
)


def test_a_statistic_below_zero_is_no_evidence_and_arrays_are_taken_element_by_element() -> None:
    assert wald_log10(-5.0, 3, 20) == pytest.approx(0.0)
    table = wald_log10(np.array([[1.0, 50.0], [2.0, 9.0]]), np.array([1, 2])[None, :], 20)
    assert table[0, 1] == pytest.approx(-stats.f.logsf(25.0, 2, 19) / np.log(10))
    assert table.shape == (2, 2)
    assert np.isfinite(wald_log10(1e7, 4, 400))


@settings(max_examples=60, deadline=None)
@given(ratio=st.floats(1.001, 20.0), count=st.integers(2, 400))
def test_the_variance_bound_never_promises_more_than_the_exact_tail(ratio: float, count: int) -> None:
    exact = -stats.chi2.logsf(ratio * count, count) / np.log(10)
    assert 0.0 <= variance_log10(ratio, count) <= exact + 1e-9
    assert variance_log10(1 / ratio, count) == 0.0


@settings(max_examples=60, deadline=None)
@given(total=st.integers(1, 300), share=st.floats(0.0, 1.0), chance=st.floats(0.01, 0.99))
def test_the_share_bound_never_promises_more_than_the_binomial_tail(
    total: int, share: float, chance: float
) -> None:
    hits = round(share * total)
    # of logarithms: binom.logsf is the logarithm of a number that may be too small for all its digits
    exact = -logsumexp(stats.binom.logpmf(np.arange(hits, total + 1), total, chance)) / np.log(10)
    assert 0.0 <= share_log10(hits, total, chance) <= exact + 1e-9


@settings(max_examples=40, deadline=None)
@given(dof=st.integers(1, 500), level=st.floats(0.51, 0.999))
def test_students_quantile_is_scipys(dof: int, level: float) -> None:
    assert student_reach(dof, level) == pytest.approx(stats.t.ppf(level, dof), rel=1e-6)


def test_the_rms_interval_covers_the_truth_as_often_as_it_says() -> None:
    rng = np.random.default_rng(6)
    hits = 0
    for _ in range(300):
        size, low, high = rms_interval(2.0 * rng.standard_normal(1000), 50)
        assert low <= size <= high
        hits += low <= 2.0 <= high
    # 95 % of 300, less three standard deviations of a binomial
    assert hits >= 285 - 3 * np.sqrt(300 * 0.95 * 0.05)


def test_one_block_tells_no_interval_shorter_than_the_size_itself() -> None:
    size, low, high = rms_interval(np.ones(10), 50)
    assert (size, low) == (1.0, 0.0)
    assert high > 2.0


def test_the_medians_half_width_covers() -> None:
    rng = np.random.default_rng(7)
    hits = sum(abs(np.median(x)) <= median_reach(x) for x in rng.standard_normal((400, 15)))
    assert hits >= 380 - 3 * np.sqrt(400 * 0.95 * 0.05)


@settings(max_examples=100, deadline=None)
@given(wald=st.floats(0.0, 1e4), width=st.integers(1, 40), blocks=st.integers(3, 400))
def test_a_wald_statistic_of_few_blocks_has_scipys_f_tail(wald: float, width: int, blocks: int) -> None:
    expected = -stats.f.logsf(wald / width, width, blocks - 1) / np.log(10)
    if expected < 240:
        # a tail of one: doubles hold half the digits of what is missing, which goes as the square root
        assert float(wald_log10(wald, width, blocks)) == pytest.approx(expected, rel=1e-6, abs=1e-7)
    assert wald_log10(2 * wald, width, 2 * blocks) >= wald_log10(wald, width, blocks) - 1e-9 or wald < width
