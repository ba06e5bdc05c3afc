"""Coefficients that few blocks carry: an error that knows it, and the count of the blocks."""

import numpy as np
import pytest

from calibration.statistics.carried import carried
from calibration.statistics.regression import gls
from calibration.statistics.tails import student_reach

BLOCK, BLOCKS = 20, 30
ROWS = np.ones(BLOCK * BLOCKS, dtype=bool)


def design(carrying: int, rng: np.random.Generator) -> np.ndarray:
    """A constant, and a column that lives in `carrying` blocks alone."""
    x = np.column_stack([np.ones(len(ROWS)), rng.standard_normal(len(ROWS))])
    x[carrying * BLOCK :, 1] = 0.0
    return x


@pytest.mark.parametrize("carrying", [2, 5, 30])
def test_the_blocks_that_carry_a_coefficient_are_counted(carrying: int) -> None:
    rng = np.random.default_rng(carrying)
    x = design(carrying, rng)
    _, blocks = carried(gls(rng.standard_normal(len(ROWS)), x, ROWS, 0, BLOCK), x, ROWS, BLOCK)
    assert blocks[0] == pytest.approx(BLOCKS, rel=0.02)
    assert 0.8 * carrying < blocks[1] <= carrying * (1 + 1e-9)


def test_errors_are_those_of_fits_without_a_block_each() -> None:
    rng = np.random.default_rng(7)
    x = design(3, rng)
    y = x @ [1.0, 2.0] + np.repeat(rng.standard_normal(BLOCKS), BLOCK)
    plain = gls(y, x, ROWS, 0, BLOCK)
    found, _ = carried(plain, x, ROWS, BLOCK)
    label = np.arange(len(y)) // BLOCK
    left = np.array([np.linalg.lstsq(x[label != k], y[label != k], rcond=None)[0] for k in range(BLOCKS)])
    jackknife = np.sqrt((BLOCKS - 1) / BLOCKS * np.sum((left - plain.beta) ** 2, axis=0))
    assert found.errors == pytest.approx(np.maximum(jackknife, plain.errors))
    assert found.beta.tolist() == plain.beta.tolist() and jackknife[1] > plain.errors[1]


def test_intervals_of_few_blocks_hold_the_truth_as_often_as_they_say() -> None:
    """A wave of each block's own, three of which carry the coefficient: 95 % within Student's reach."""
    held = {"plain": 0, "carried": 0}
    for seed in range(400):
        rng = np.random.default_rng(seed)
        x = design(3, rng)
        x[:, 1] += np.where(np.arange(len(ROWS)) < 3 * BLOCK, 1.0, 0.0)
        y = np.repeat(rng.standard_normal(BLOCKS), BLOCK) + 0.1 * rng.standard_normal(len(ROWS))
        plain = gls(y, x, ROWS, 0, BLOCK)
        fit, blocks = carried(plain, x, ROWS, BLOCK)
        held["plain"] += abs(plain.beta[1]) < student_reach(BLOCKS - 2) * plain.errors[1]
        held["carried"] += abs(fit.beta[1]) < student_reach(max(blocks[1] - 2, 3)) * fit.errors[1]
    assert held["plain"] < 0.88 * 400 < 0.92 * 400 < held["carried"]


@pytest.mark.parametrize("rows", [0, 15])
def test_one_block_or_none_says_nothing_more(rows: int) -> None:
    x, y, valid = np.ones((40, 1)), np.ones(40), np.arange(40) < rows
    fit = gls(y, x, valid, 0, BLOCK)
    same, blocks = carried(fit, x, valid, BLOCK)
    assert same is fit and blocks.tolist() == [float(rows > 0)]


def test_a_column_without_weight_is_carried_by_nothing() -> None:
    rng = np.random.default_rng(3)
    x = np.column_stack([design(9, rng), np.zeros(len(ROWS))])
    fit, blocks = carried(gls(rng.standard_normal(len(ROWS)), x, ROWS, 0, BLOCK), x, ROWS, BLOCK)
    assert blocks[2] == 0.0 and fit.errors[2] == 0.0 and np.all(np.isfinite(fit.covariance))
