"""Least squares against numpy's, generalised least squares against its closed forms."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import cho_factor, cho_solve, toeplitz

from calibration.statistics.regression import block_covariance, gls, leverage, solve, under
from calibration.statistics.whitening import Whitener

SEEDS = st.integers(0, 2**32 - 1)
SHAPES = st.tuples(st.integers(12, 80), st.integers(1, 6))


def made(seed: int, shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """A design (n, p) with columns of very different size, and a column to explain (n,)."""
    rng = np.random.default_rng(seed)
    x = rng.standard_normal(shape) * 10.0 ** rng.integers(-6, 7, shape[1])
    return x, rng.standard_normal(shape[0])


@settings(max_examples=60, deadline=None)
@given(seed=SEEDS, shape=SHAPES)
def test_solve_is_numpys_least_squares_whatever_the_columns_size(seed: int, shape: tuple[int, int]) -> None:
    x, y = made(seed, shape)
    size = np.linalg.norm(x, axis=0)
    expected = np.linalg.lstsq(x / size, y, rcond=None)[0]
    assert solve(x, y) * size == pytest.approx(expected, abs=1e-7)


@settings(max_examples=60, deadline=None)
@given(seed=SEEDS, shape=SHAPES)
def test_what_solve_leaves_is_orthogonal_to_every_column(seed: int, shape: tuple[int, int]) -> None:
    x, y = made(seed, shape)
    left = y - x @ solve(x, y)
    assert (x / np.linalg.norm(x, axis=0)).T @ left == pytest.approx(np.zeros(shape[1]), abs=1e-7)


@settings(max_examples=40, deadline=None)
@given(seed=SEEDS, shape=SHAPES, factor=st.floats(1e-3, 1e3))
def test_a_column_in_another_unit_has_its_coefficient_in_that_unit(
    seed: int, shape: tuple[int, int], factor: float
) -> None:
    x, y = made(seed, shape)
    other = x.copy()
    other[:, 0] *= factor
    assert solve(other, y)[0] * factor == pytest.approx(solve(x, y)[0], rel=1e-6, abs=1e-300)
    assert other @ solve(other, y) == pytest.approx(x @ solve(x, y), abs=1e-7)


def test_a_column_without_weight_gets_no_coefficient_and_a_column_twice_shares_it() -> None:
    rng = np.random.default_rng(1)
    x = rng.standard_normal((50, 1))
    y = 3.0 * x[:, 0]
    assert solve(np.hstack([x, np.zeros((50, 1))]), y) == pytest.approx([3.0, 0.0])
    assert solve(np.hstack([x, x]), y) == pytest.approx([1.5, 1.5])


@settings(max_examples=40, deadline=None)
@given(seed=SEEDS, shape=SHAPES)
def test_leverages_of_the_fitted_rows_sum_to_the_rank(seed: int, shape: tuple[int, int]) -> None:
    x, _ = made(seed, shape)
    h = leverage(x, x)
    assert h.sum() == pytest.approx(shape[1], rel=1e-6)
    assert np.all((h > -1e-9) & (h < 1 + 1e-9))


def test_leverage_grows_with_the_distance_from_what_was_fitted() -> None:
    x = np.column_stack([np.ones(11), np.linspace(-1, 1, 11)])
    at = np.column_stack([np.ones(3), [0.0, 1.0, 3.0]])
    expected = 1 / 11 + at[:, 1] ** 2 / np.sum(x[:, 1] ** 2)  # of a straight line, by the textbook
    assert leverage(x, at) == pytest.approx(expected)


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS)
def test_without_colour_gls_is_least_squares_on_the_valid_rows(seed: int) -> None:
    rng = np.random.default_rng(seed)
    x, y = rng.standard_normal((200, 3)), rng.standard_normal(200)
    valid = rng.random(200) > 0.2
    fit = gls(y, x, valid, order=0)
    assert fit.beta == pytest.approx(np.linalg.lstsq(x[valid], y[valid], rcond=None)[0])
    assert fit.residual == pytest.approx(y - x @ fit.beta)
    assert fit.rows == valid.sum()
    assert fit.sigma == pytest.approx(np.sqrt(np.mean(fit.residual[valid] ** 2)))


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS, order=st.sampled_from([0, 1, 4]), junk=st.floats(-1e6, 1e6))
def test_what_stands_in_rows_that_are_not_valid_changes_nothing(seed: int, order: int, junk: float) -> None:
    rng = np.random.default_rng(seed)
    x, y = rng.standard_normal((300, 2)), rng.standard_normal(300)
    valid = rng.random(300) > 0.1
    other = np.where(valid, y, junk)
    one, two = gls(y, x, valid, order), gls(other, x, valid, order)
    assert one.beta == pytest.approx(two.beta)
    assert one.loglik == pytest.approx(two.loglik)
    assert under(y, x, valid, one.whitener) == pytest.approx(under(other, x, valid, one.whitener))


def test_gls_on_coloured_noise_is_nearer_to_the_exact_solution_than_least_squares() -> None:
    """Against the Cholesky solution with the noise's true covariance, of AR(1) with 0.9; a quick column."""
    n, a = 800, 0.9
    t = np.arange(n)
    x = np.column_stack([np.ones(n), t / n, np.random.default_rng(99).standard_normal(n)])
    covariance = cho_factor(toeplitz(a**t) / (1 - a**2))
    ours, plain = [], []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        e = rng.standard_normal(n)
        for k in range(1, n):
            e[k] += a * e[k - 1]
        y = x @ [1.0, 2.0, 0.5] + e
        exact = np.linalg.solve(x.T @ cho_solve(covariance, x), x.T @ cho_solve(covariance, y))
        ours.append((gls(y, x, np.ones(n, bool), 4).beta - exact)[2])
        plain.append((np.linalg.lstsq(x, y, rcond=None)[0] - exact)[2])
    assert np.std(ours) < 0.6 * np.std(plain)


def test_the_block_covariance_of_white_noise_is_the_textbooks() -> None:
    rng = np.random.default_rng(2)
    x = rng.standard_normal((6000, 3))
    found = np.mean(
        [block_covariance(x, rng.standard_normal(6000), 50).diagonal() for _ in range(20)], axis=0
    )
    assert found == pytest.approx(np.linalg.inv(x.T @ x).diagonal(), rel=0.25)


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS, factor=st.floats(1e-4, 1e4))
def test_the_block_covariance_follows_the_unit_of_a_column(seed: int, factor: float) -> None:
    rng = np.random.default_rng(seed)
    x, e = rng.standard_normal((400, 2)), rng.standard_normal(400)
    other = x * [factor, 1.0]
    one, two = block_covariance(x, e, 40), block_covariance(other, e, 40)
    assert two[0, 0] * factor**2 == pytest.approx(one[0, 0], rel=1e-6)
    assert two[1, 1] == pytest.approx(one[1, 1], rel=1e-6)


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS, block=st.integers(5, 100))
def test_the_block_covariance_is_never_below_that_of_white_noise(seed: int, block: int) -> None:
    rng = np.random.default_rng(seed)
    x, e = rng.standard_normal((500, 3)), rng.standard_normal(500)
    white = np.linalg.inv(x.T @ x) * np.sum(e**2) / (500 - 3)
    assert np.all(block_covariance(x, e, block).diagonal() >= white.diagonal() * (1 - 1e-9))


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS, pole=st.floats(-0.8, 0.8))
def test_a_further_column_never_lowers_the_likelihood_through_one_filter(seed: int, pole: float) -> None:
    rng = np.random.default_rng(seed)
    x, y, valid = rng.standard_normal((200, 3)), rng.standard_normal(200), rng.random(200) > 0.05
    w = Whitener(np.array([pole]))
    gains = [under(y, x[:, :k], valid, w) for k in range(4)]
    assert np.all(np.diff(gains) >= -1e-9)


def test_the_likelihood_is_the_normal_one_but_for_a_constant() -> None:
    """n log of the rms is what the normal likelihood leaves at its maximum beside -n/2 log 2 pi e."""
    rng = np.random.default_rng(3)
    y, none = rng.standard_normal(100), np.zeros((100, 0))
    found = under(y, none, np.ones(100, bool), Whitener(np.zeros(0)))
    sigma = np.sqrt(np.mean(y**2))
    whole = np.sum(-0.5 * np.log(2 * np.pi * sigma**2) - y**2 / (2 * sigma**2))
    assert found == pytest.approx(whole + 50 * np.log(2 * np.pi * np.e))
