"""The autoregressive filter against scipy's, its fit against Yule and Walker's closed form."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter

from calibration.statistics.thresholds import LOADING, ROWS_PER_ORDER
from calibration.statistics.whitening import Whitener, autocovariance, fit_ar

SEEDS = st.integers(0, 2**32 - 1)
POLES = st.lists(st.floats(-0.9, 0.9), min_size=0, max_size=6)


@settings(max_examples=60, deadline=None)
@given(seed=SEEDS, a=POLES)
def test_the_filter_is_scipys(seed: int, a: list[float]) -> None:
    x = np.random.default_rng(seed).standard_normal(60)
    assert Whitener(np.array(a)).apply(x) == pytest.approx(lfilter([1.0, *(-np.array(a))], [1.0], x))


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS, a=POLES)
def test_columns_are_filtered_as_if_alone_and_stay_as_they_were(seed: int, a: list[float]) -> None:
    x = np.random.default_rng(seed).standard_normal((40, 3))
    before, w = x.copy(), Whitener(np.array(a))
    assert w.apply(x) == pytest.approx(np.column_stack([w.apply(c) for c in x.T]))
    assert np.array_equal(x, before)


@settings(max_examples=40, deadline=None)
@given(seed=SEEDS, a=POLES, b=st.floats(-5, 5))
def test_the_filter_is_linear(seed: int, a: list[float], b: float) -> None:
    x, y = np.random.default_rng(seed).standard_normal((2, 50))
    w = Whitener(np.array(a))
    assert w.apply(x + b * y) == pytest.approx(w.apply(x) + b * w.apply(y), abs=1e-9)


@settings(max_examples=60, deadline=None)
@given(valid=st.lists(st.booleans(), min_size=1, max_size=40), order=st.integers(0, 5))
def test_a_row_is_usable_with_itself_and_all_that_the_filter_needs(valid: list[bool], order: int) -> None:
    use = Whitener(np.zeros(order)).usable(np.array(valid))
    expected = [k >= order and all(valid[k - order : k + 1]) for k in range(len(valid))]
    assert use.tolist() == expected


@settings(max_examples=40, deadline=None)
@given(seed=SEEDS, lags=st.integers(0, 6))
def test_the_autocovariance_is_the_sum_of_products_of_valid_pairs(seed: int, lags: int) -> None:
    rng = np.random.default_rng(seed)
    e, valid = rng.standard_normal(50), rng.random(50) > 0.3
    x = np.where(valid, e, 0.0)
    expected = [np.sum(x[k:] * x[: 50 - k]) / max(valid.sum(), 1) for k in range(lags + 1)]
    assert autocovariance(e, valid, lags) == pytest.approx(expected, abs=1e-12)


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS)
def test_the_first_order_is_yule_and_walkers_with_the_loading(seed: int) -> None:
    e = np.random.default_rng(seed).standard_normal(200)
    r = autocovariance(e - e.mean(), np.ones(200, bool), 1)
    assert fit_ar(e, np.ones(200, bool), 1).a == pytest.approx([r[1] / (r[0] * (1 + LOADING))])


@pytest.mark.parametrize("pole", [-0.7, 0.3, 0.95])
def test_the_pole_of_coloured_noise_is_found_but_for_the_loading(pole: float) -> None:
    e = lfilter([1.0], [1.0, -pole], np.random.default_rng(4).standard_normal(50000))
    assert fit_ar(e, np.ones(len(e), bool), 1).a == pytest.approx([pole / (1 + LOADING)], abs=0.02)


def test_a_mean_is_no_colour_and_a_short_series_has_no_filter() -> None:
    e = np.random.default_rng(5).standard_normal(4000)
    valid = np.ones(4000, bool)
    assert fit_ar(e + 1e3, valid, 2).a == pytest.approx(fit_ar(e, valid, 2).a, abs=1e-6)
    assert len(fit_ar(e, valid, 0).a) == 0
    few = np.arange(4000) < 4 * ROWS_PER_ORDER - 1
    assert len(fit_ar(e, few, 4).a) == 0
    assert len(fit_ar(np.zeros(4000), valid, 4).a) == 0
