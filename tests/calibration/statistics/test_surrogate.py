"""Scores of candidates against projections, and their threshold on noise."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from calibration.statistics.surrogate import basis, orthonormal_blocks, score, taken_away, together

SEEDS = st.integers(0, 2**32 - 1)


def signs(rng: np.random.Generator, draws: int, rows: int, block: int) -> np.ndarray:
    return rng.choice([-1.0, 1.0], size=(draws, len(range(0, rows, block))))


@settings(max_examples=40, deadline=None)
@given(seed=SEEDS, widths=st.lists(st.integers(1, 4), min_size=1, max_size=4))
def test_blocks_are_orthonormal_and_at_right_angles_to_the_base(seed: int, widths: list[int]) -> None:
    rng = np.random.default_rng(seed)
    base, x = rng.standard_normal((60, 2)), rng.standard_normal((60, sum(widths)))
    q, kept = orthonormal_blocks(np.split(x, np.cumsum(widths)[:-1], axis=1), basis(base))
    assert kept == widths
    assert base.T @ q == pytest.approx(np.zeros((2, sum(widths))), abs=1e-9)
    at = 0
    for k in kept:
        part = q[:, at : at + k]
        assert part.T @ part == pytest.approx(np.eye(k), abs=1e-9)
        at += k


@settings(max_examples=40, deadline=None)
@given(seed=SEEDS, width=st.integers(1, 4))
def test_what_a_block_takes_away_is_what_least_squares_takes(seed: int, width: int) -> None:
    rng = np.random.default_rng(seed)
    e, base, x = rng.standard_normal(80), rng.standard_normal((80, 3)), rng.standard_normal((80, width))
    taken, kept = taken_away(e, basis(base), [x])

    def left(design: np.ndarray) -> float:
        return float(np.sum((e - design @ np.linalg.lstsq(design, e, rcond=None)[0]) ** 2))

    assert kept == [width]
    assert taken[0] == pytest.approx(left(base) - left(np.hstack([base, x])), rel=1e-8)


def test_a_column_of_the_base_and_a_column_twice_count_once_or_not_at_all() -> None:
    rng = np.random.default_rng(8)
    base, x, e = rng.standard_normal((50, 2)), rng.standard_normal((50, 1)), rng.standard_normal(50)
    blocks = [base[:, :1], np.hstack([x, 2 * x]), x]
    taken, kept = taken_away(e, basis(base), blocks)
    assert kept == [0, 1, 1]
    assert taken[0] == 0.0
    assert taken[1] == pytest.approx(taken[2])
    assert orthonormal_blocks(blocks, basis(base))[1] == [0, 1, 1]
    assert taken_away(e, basis(base), []) == ([], [])


def test_scores_of_white_noise_are_uniform_in_p() -> None:
    rng = np.random.default_rng(9)
    q, widths = orthonormal_blocks(list(rng.standard_normal((200, 2000, 1))), basis(np.zeros((2000, 0))))
    e = rng.standard_normal(2000)
    value = score(e, e, q, widths, 20, signs(rng, 1, 2000, 20))[0]
    assert stats.kstest(10.0**-value, "uniform").pvalue > 0.01


def test_the_threshold_is_passed_by_as_many_nulls_as_its_level_says() -> None:
    rng = np.random.default_rng(10)
    q, widths = orthonormal_blocks(list(rng.standard_normal((15, 1000, 2))), basis(np.zeros((1000, 0))))
    noise = rng.standard_normal(1000)
    scores = together([score(noise, noise, q, widths, 20, signs(rng, 400, 1000, 20))], 0.95)
    passed = np.mean(scores.surrogate_max > scores.threshold)
    assert passed == pytest.approx(0.05, abs=1 / 400)
    fresh = [score(e, e, q, widths, 20, signs(rng, 1, 1000, 20)) for e in rng.standard_normal((200, 1000))]
    alarms = np.mean([value.max() > scores.threshold for value, _ in fresh])
    assert alarms < 0.05 + 3 * np.sqrt(0.05 * 0.95 / 200)


def test_a_planted_column_is_beyond_the_threshold_and_the_largest() -> None:
    rng = np.random.default_rng(11)
    x = rng.standard_normal((1000, 20))
    q, widths = orthonormal_blocks([x[:, [k]] for k in range(20)], basis(np.zeros((1000, 0))))
    noise = rng.standard_normal(1000)
    scores = together([score(noise + 0.5 * x[:, 7], noise, q, widths, 20, signs(rng, 400, 1000, 20))], 0.99)
    assert int(np.argmax(scores.value)) == 7
    assert scores.value[7] > scores.threshold
    assert scores.value[7] > scores.surrogate_max.max()


def test_parts_scored_apart_are_scored_as_together() -> None:
    rng = np.random.default_rng(12)
    q, widths = orthonormal_blocks(list(rng.standard_normal((4, 400, 2))), basis(np.zeros((400, 0))))
    e, s = rng.standard_normal(400), signs(rng, 50, 400, 20)
    whole = together([score(e, e, q, widths, 20, s)], 0.9)
    apart = together([score(e, e, q[:, k : k + 4], [2, 2], 20, s) for k in (0, 4)], 0.9)
    assert apart.value == pytest.approx(whole.value)
    assert apart.threshold == pytest.approx(whole.threshold)
