"""Fits without one session, what a fit tells of other rows, and twins, against plain least squares."""

import numpy as np
import pytest

from calibration.statistics.regression import (
    Fit,
    block_covariance,
    gls,
    inflation,
    leverage,
    solve,
    solve_without,
    told,
    under,
)  # fmt: skip
from calibration.statistics.whitening import Whitener

RNG = np.random.default_rng(4)
X = RNG.standard_normal((90, 3)) * [1.0, 1e4, 1e-4]
Y = X @ [2.0, 3e-4, -5e4] + RNG.standard_normal(90)
LABEL = np.repeat([3, 7, 5], 30)


def test_errors_are_the_roots_of_the_variances_and_no_less_than_none() -> None:
    fit = Fit(np.zeros(3), np.diag([4.0, 0.25, -1e-18]), np.zeros(1), Whitener(np.zeros(0)), 1.0, 0.0, 1)
    assert fit.errors.tolist() == [2.0, 0.5, 0.0]


def test_every_session_is_left_out_in_its_turn() -> None:
    found = solve_without(X, Y, LABEL)
    assert len(found) == 3
    for k, beta in zip((3, 5, 7), found, strict=True):
        rest = k != LABEL
        assert beta == pytest.approx(np.linalg.lstsq(X[rest], Y[rest], rcond=None)[0])


def test_rows_are_told_that_lie_in_what_was_fitted() -> None:
    x = np.column_stack([np.ones(50), np.linspace(-1, 1, 50), np.zeros(50)])
    at = np.array([[1.0, 0.5, 0.0], [1.0, 100.0, 0.0], [1.0, 0.0, 1e-3], [1.0, 0.0, 1e-7], [0.0, 0.0, 0.0]])
    # 100 is too far from the fitted rows; the third column was never moved
    assert told(x, at).tolist() == [True, False, False, True, True]


@pytest.mark.parametrize(("far", "is_told"), [(3.9, True), (4.0, True), (4.1, False)])
def test_a_prediction_is_no_noisier_than_the_noise(far: float, is_told: bool) -> None:
    """One column of 16 ones: the variance at x is x^2 / 16."""
    x, at = np.ones((16, 1)), np.array([[far]])
    assert leverage(x, at)[0] == pytest.approx(far**2 / 16)
    if far != 4.0:
        assert bool(told(x, at)[0]) is is_told


def test_twins_cannot_be_told_apart_and_their_mean_can() -> None:
    a = RNG.standard_normal(40)
    x = np.column_stack([a, a])
    assert told(x, np.array([[0.1, 0.1], [0.1, -0.1], [0.1, 0.1001]])).tolist() == [True, False, True]


def test_inflation_is_one_for_what_stands_alone() -> None:
    """By the others' correlation r it is 1 / (1 - r^2)."""
    a, b = np.linalg.qr(RNG.standard_normal((50, 2)))[0].T
    assert inflation(np.column_stack([a, 7.0 * b])) == pytest.approx([1.0, 1.0])
    r = 0.8
    mixed = r * a + np.sqrt(1 - r**2) * b
    assert inflation(np.column_stack([a, 1e5 * mixed, np.zeros(50)]))[:2] == pytest.approx([1 / 0.36] * 2)
    assert inflation(np.column_stack([a, a])).min() > 1e10
    assert inflation(np.column_stack([a, np.zeros(50)]))[1] > 1e10


def test_nearly_twins_are_told_apart_down_to_half_of_a_doubles_digits() -> None:
    a, b = np.linalg.qr(RNG.standard_normal((50, 2)))[0].T
    for off, apart in ((1e-4, True), (1e-6, False)):
        x = np.column_stack([a, a + off * b])
        beta = solve(x, a + off * b)
        assert (beta == pytest.approx([0.0, 1.0], abs=1e-3)) is apart, off


def test_a_fit_of_nothing_or_of_zeros_is_zero() -> None:
    assert solve(np.zeros((5, 2)), np.ones(5)).tolist() == [0.0, 0.0]
    assert solve(np.zeros((5, 0)), np.ones(5)).shape == (0,)
    tiny = 1e-140 * RNG.standard_normal((20, 1))
    assert solve(tiny, 3.0 * tiny[:, 0]) == pytest.approx([3.0])


def test_a_fit_is_whitened_twice_in_blocks_of_two_hundred_rows() -> None:
    n = 1000
    e = RNG.standard_normal(n)
    for k in range(1, n):
        e[k] += 0.7 * e[k - 1]
    x = np.column_stack([np.ones(n), np.arange(n) / n])
    valid = np.arange(n) % 97 != 5
    plain, said = gls(e, x, valid, 2), gls(e, x, valid, 2, block=200, rounds=2)
    once, thrice = (gls(e, x, valid, 2, rounds=k) for k in (1, 3))
    assert plain.beta.tolist() == said.beta.tolist() and plain.covariance.tolist() == said.covariance.tolist()
    assert plain.beta.tolist() != thrice.beta.tolist() and plain.beta.tolist() != once.beta.tolist()
    usable = plain.whitener.usable(valid)
    left = plain.whitener.apply(np.where(valid, e, 0.0) - np.where(valid[:, None], x, 0.0) @ plain.beta)[
        usable
    ]
    assert plain.rows == usable.sum() and plain.sigma == pytest.approx(np.sqrt(np.mean(left**2)))
    assert plain.loglik == pytest.approx(-usable.sum() * np.log(plain.sigma))
    assert gls(e, x, valid, 2, block=201).covariance.tolist() != plain.covariance.tolist()
    assert len(gls(e, x, valid, 0).whitener.a) == 0
    assert under(e, x, valid, plain.whitener) == pytest.approx(plain.loglik, rel=1e-3)


def test_no_valid_row_is_no_fit() -> None:
    x, none = np.ones((10, 1)), np.zeros(10, dtype=bool)
    fit = gls(np.ones(10), x, none, 0)
    assert (fit.rows, fit.sigma, fit.beta.tolist()) == (1, 0.0, [0.0])
    floor = -np.log(1e-300)  # rms of nothing
    assert fit.loglik == pytest.approx(floor)
    assert under(np.ones(10), x, none, Whitener(np.zeros(0))) == pytest.approx(floor)


def test_a_sandwich_of_blocks_is_worked_out_by_hand() -> None:
    """Two blocks of two rows: scores 2 and 4, corrected by 2 / 1 blocks; four ones for the bread."""
    x, e = np.ones((4, 1)), np.array([0.5, 1.5, 1.0, 3.0])
    assert block_covariance(x, e, 2)[0, 0] == pytest.approx((4.0 + 16.0) * 2 / 16)

    one = block_covariance(x, e, 9)[0, 0]  # one block is corrected by nothing
    assert one == pytest.approx(36.0 / 16)
