"""Scores of orthonormal blocks and of surrogates, a basis of any scale, and noise from row to row."""

import numpy as np
import pytest

from calibration.statistics.surrogate import basis, orthonormal_blocks, score, taken_away, together
from calibration.statistics.tails import wald_log10
from calibration.statistics.whitening import (
    Whitener,
    autocovariance,
    coherence,
    fit_ar,
    white_noise,
)  # fmt: skip

RNG = np.random.default_rng(8)


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_a_basis_spans_what_it_was_made_of_whatever_its_scale(scale: float) -> None:
    x = RNG.standard_normal((60, 3)) * [scale, 1.0, 1.0]
    q = basis(x)
    assert q.T @ q == pytest.approx(np.eye(3), abs=1e-12)
    assert q @ (q.T @ x) == pytest.approx(x, abs=1e-9 * max(scale, 1.0))


def test_a_score_is_a_wald_statistic_by_its_own_block_sums() -> None:
    """Three blocks of two rows: sums of q times noise are 1, 2 and 3, so the variance is 14."""
    q = np.full((6, 1), 1.0)
    noise = np.array([0.5, 0.5, 1.0, 1.0, 1.5, 1.5])
    e = np.array([1.0, 2.0, 3.0, 1.0, 0.0, 0.0])
    signs = np.array([[1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [-1.0, -1.0, 1.0]])
    value, largest = score(e, noise, q, [1], 2, signs)
    assert value == pytest.approx(wald_log10(np.array([49.0 / 14]), 1, 3))
    assert largest == pytest.approx(wald_log10(np.array([36.0, 4.0, 0.0]) / 14, 1, 3))


def test_every_candidate_has_its_columns_and_a_surrogate_its_best() -> None:
    q = RNG.standard_normal((40, 3))
    noise, e, signs = RNG.standard_normal(40), RNG.standard_normal(40), np.ones((2, 8))
    value, largest = score(e, noise, q, [2, 1], 5, signs)
    apart = [
        score(e, noise, q[:, at], [width], 5, signs) for at, width in ((slice(0, 2), 2), (slice(2, 3), 1))
    ]
    assert value == pytest.approx([apart[0][0][0], apart[1][0][0]])
    assert largest == pytest.approx(np.maximum(apart[0][1], apart[1][1]))
    nothing = score(e, noise, np.zeros((40, 0)), [0], 5, signs)
    assert nothing[0].tolist() == [0.0] and nothing[1].tolist() == [0.0, 0.0]
    assert score(e, noise, q, [], 5, signs)[1].tolist() == [0.0, 0.0]


def test_a_variance_is_no_less_than_the_noises() -> None:
    """Blocks whose sums are none by luck: the floor is the mean square of the noise, 4."""
    q, noise = np.full((4, 1), 0.5), np.array([2.0, -2.0, 2.0, -2.0])
    value, _ = score(np.full(4, 3.0), noise, q, [1], 2, np.ones((1, 2)))
    assert value == pytest.approx(wald_log10(np.array([36.0 / 4.0]), 1, 2))
    silent, _ = score(np.full(4, 3.0), np.zeros(4), q, [1], 2, np.ones((1, 2)))
    assert silent == pytest.approx(wald_log10(np.array([36.0]), 1, 2))


def test_the_threshold_is_a_quantile_of_the_largest_of_all_parts() -> None:
    parts = [(np.array([1.0, 2.0]), np.array([5.0, 1.0, 3.0])), (np.array([7.0]), np.array([2.0, 4.0, 3.5]))]
    found = together(parts, 0.5)
    assert found.value.tolist() == [1.0, 2.0, 7.0] and found.surrogate_max.tolist() == [5.0, 4.0, 3.5]
    assert found.threshold == 4.0


def test_a_small_column_counts_and_what_the_basis_has_does_not() -> None:
    q = basis(np.ones((50, 1)))
    t = np.linspace(-1, 1, 50)
    for scale in (1e-8, 1.0, 1e8):
        turned, widths = orthonormal_blocks([scale * t[:, None], np.full((50, 1), scale)], q)
        assert widths == [1, 0] and np.abs(turned[:, 0]) == pytest.approx(np.abs(t) / np.linalg.norm(t))
    squares, counts = taken_away(3.0 * t + 5.0, q, [t[:, None], np.ones((50, 1))])
    assert squares == pytest.approx([9.0 * np.sum(t**2), 0.0]) and counts == [1, 0]


def series(n: int = 5000) -> np.ndarray:
    return RNG.standard_normal(n)


def test_noise_from_row_to_row_is_white_noises() -> None:
    """Of means over two boxcars, whose second difference has 6 - 32 / 19 of the variance."""
    valid = np.ones(5, dtype=bool)
    one = np.array([0.0, 0.0, 3.0, 0.0, 0.0])  # second differences 3, -6, 3
    assert white_noise(one, valid) == pytest.approx(np.sqrt(18.0) / np.sqrt(6 - 32 / 19))
    assert white_noise(one, valid, bursts=False) == pytest.approx(1.4826 * 3.0 / np.sqrt(6 - 32 / 19))
    valid[0] = False
    assert white_noise(one, valid) == pytest.approx(np.sqrt(22.5) / np.sqrt(6 - 32 / 19))


def test_an_autocovariance_is_of_pairs_that_are_both_there() -> None:
    e, valid = np.array([1.0, 2.0, 9.0, 4.0]), np.array([True, True, False, True])
    assert autocovariance(e, valid, 3) == pytest.approx([21 / 3, 2 / 3, 8 / 3, 4 / 3])
    assert autocovariance(e, np.zeros(4, dtype=bool), 1) == pytest.approx([0.0, 0.0])


@pytest.mark.parametrize(("rows", "order"), [(10, 2), (9, 0)])
def test_a_filter_takes_five_rows_for_every_coefficient(rows: int, order: int) -> None:
    e = series(20)
    assert len(fit_ar(e, np.arange(20) < rows, 2).a) == order
    assert len(fit_ar(np.ones(20), np.ones(20, dtype=bool), 2).a) == 0


def test_a_filter_solves_yule_and_walker_with_its_loading() -> None:
    e, valid = series(400), np.ones(400, dtype=bool)
    e[1:] += 0.8 * e[:-1]
    x = e - e.mean()
    r = [float(np.sum(x[k:] * x[: 400 - k])) / 400 for k in range(4)]
    r0 = 1.3 * r[0]
    matrix = np.array([[r0, r[1], r[2]], [r[1], r0, r[1]], [r[2], r[1], r0]])
    assert fit_ar(e, valid, 3).a == pytest.approx(np.linalg.solve(matrix, r[1:]))


def test_rows_without_a_number_are_none_to_the_filter() -> None:
    w = Whitener(np.array([0.5]))
    x, valid = np.array([1.0, 2.0, 99.0, 4.0, 8.0]), np.array([True, True, False, True, True])
    assert w.whiten(x, valid).tolist() == [1.5, 6.0]
    assert w.whiten(x[:, None], valid).tolist() == [[1.5], [6.0]]


def test_coherence_is_of_pairs_of_one_session_that_are_enough() -> None:
    turn = np.cos(2 * np.pi * np.arange(300) / 100)
    rows, session = np.ones(300, dtype=bool), np.zeros(300, dtype=np.int64)
    assert coherence(turn, rows, session, 50) == pytest.approx(1.0, abs=0.01)  # half a turn later
    assert coherence(turn, rows, session, 100) == pytest.approx(1.0, abs=0.01)  # two hundred pairs
    assert coherence(turn, rows, session, 101) == 0.0
    quarter = np.where(np.arange(300) < 260, turn, 0.0)
    assert coherence(quarter, np.arange(300) < 251, session, 51) == pytest.approx(
        np.corrcoef(quarter[51:251], quarter[:200])[0, 1] ** 2
    )
    assert coherence(turn, rows, np.arange(300) // 150, 51) == 0.0  # 99 pairs of each
