"""Held-out scores: who is compared on which rows, against closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from calibration.decide.heldout import Model, compare, cross_validate, folds, paired_z
from calibration.decide.thresholds import FEWEST_HELD, FOLDS
from calibration.statistics.regression import solve
from calibration.statistics.whitening import Whitener
from tests.calibration.decide.made import problem

PLAIN = Whitener(np.zeros(0))
SEEDS = st.integers(0, 2**32 - 1)


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS, size=st.floats(-3.0, 3.0))
def test_a_comparison_is_the_rms_of_either_model_on_held_out_rows(seed: int, size: float) -> None:
    rng = np.random.default_rng(seed)
    x, y = rng.standard_normal((400, 2)), rng.standard_normal(400)
    p = problem(y)
    one, other = Model(x=x[:, :1], beta=np.array([size])), Model(x=x, beta=np.array([size, 0.5]))
    found = compare(p, one, other, PLAIN)
    before, after = (np.sqrt(np.mean((y - m.x @ m.beta)[p.test] ** 2)) for m in (one, other))
    assert (found.before, found.after) == (pytest.approx(before), pytest.approx(after))
    assert found.share == pytest.approx(1 - (after / before) ** 2)


@settings(max_examples=20, deadline=None)
@given(seed=SEEDS, junk=st.floats(-1e3, 1e3))
def test_fitted_rows_do_not_matter_to_a_comparison_nor_held_out_rows_to_a_validation(
    seed: int, junk: float
) -> None:
    rng = np.random.default_rng(seed)
    x, y = rng.standard_normal((800, 2)), rng.standard_normal(800)
    p = problem(y)
    q = problem(np.where(p.train, junk, y))
    one, other = Model(x=x[:, :1], beta=np.ones(1)), Model(x=x, beta=np.ones(2))
    assert compare(p, one, other, PLAIN) == compare(q, one, other, PLAIN)
    r = problem(np.where(p.test, junk, y))
    assert cross_validate(p, x[:, :1], x, PLAIN) == cross_validate(r, x[:, :1], x, PLAIN)


def test_a_model_against_itself_gains_nothing_and_too_few_rows_say_nothing() -> None:
    y = np.random.default_rng(1).standard_normal(400)
    p, model = problem(y), Model(x=np.ones((400, 1)), beta=np.zeros(1))
    same = compare(p, model, model, PLAIN)
    assert (same.share, same.z) == (0.0, 0.0)
    p.held = np.arange(400) < FEWEST_HELD - 1
    assert np.isnan(compare(p, model, model, PLAIN).before)


def test_a_true_column_gains_in_every_fold_and_a_random_one_loses() -> None:
    rng = np.random.default_rng(2)
    x = rng.standard_normal((2000, 2))
    p = problem(2.0 * x[:, 0] + rng.standard_normal(2000))
    base = np.ones((2000, 1))
    true = cross_validate(p, base, np.hstack([base, x[:, :1]]), PLAIN)
    assert true.everywhere and true.z > 5
    assert true.share == pytest.approx(4.0 / 5.0, abs=0.05)  # 2^2 of 2^2 + 1
    shares = []
    for seed in range(20):
        noise = np.random.default_rng(seed).standard_normal((2000, 1))
        shares.append(cross_validate(p, base, np.hstack([base, noise]), PLAIN).share)
    assert np.mean(shares) < 0.0


@settings(max_examples=40, deadline=None)
@given(rows=st.integers(150, 900), runs=st.integers(1, 5))
def test_folds_are_all_dealt_and_neighbours_in_a_piece_stay_together(rows: int, runs: int) -> None:
    p = problem(np.zeros(rows), runs=runs + 1)
    use = p.train
    fold = folds(p, use)
    assert set(fold) <= set(range(FOLDS)) and len(fold) == use.sum()
    sizes = np.bincount(fold, minlength=FOLDS)
    assert sizes.max() <= use.sum() * 0.6
    changes = np.count_nonzero(np.diff(fold))
    assert changes < len(fold) / 4  # pieces of rows, never single ones


@settings(max_examples=40, deadline=None)
@given(seed=SEEDS, block=st.integers(5, 30))
def test_a_z_has_no_unit_and_turns_its_sign_with_the_gain(seed: int, block: int) -> None:
    gain = np.random.default_rng(seed).standard_normal(600) + 0.1
    assert paired_z(7.0 * gain, block) == pytest.approx(paired_z(gain, block))
    assert paired_z(-gain, block) == pytest.approx(-paired_z(gain, block))
    assert paired_z(np.full(600, 3.0), block if 600 % block == 0 else 30) == 0.0


def test_a_z_of_noise_is_a_standard_normal() -> None:
    rng = np.random.default_rng(3)
    z = [paired_z(rng.standard_normal(2000), 20) for _ in range(300)]
    assert np.mean(z) == pytest.approx(0.0, abs=3 / np.sqrt(300))
    assert np.std(z) == pytest.approx(1.0, abs=3 / np.sqrt(600))


def test_an_offset_of_an_unseen_segment_is_fitted_where_it_is() -> None:
    rng = np.random.default_rng(4)
    x = rng.standard_normal((400, 1))
    p = problem(2.0 * x[:, 0])
    p.y = p.y + 50.0 * p.held
    p.fresh = p.held[:, None].astype(float)
    assert Model(x=x, beta=np.array([2.0])).residual(p, p.test) == pytest.approx(
        np.zeros(p.test.sum()), abs=1e-9
    )


def test_a_line_of_known_size_takes_the_phase_of_a_run_that_was_not_fitted() -> None:
    t = np.arange(400) / 40.0
    p = problem(np.zeros(400))
    phase = np.array([0.3, 1.4, 2.0, -2.2])[p.run]
    p.y = 1.5 * np.cos(2 * np.pi * t + phase)
    pairs = np.zeros((400, 8))
    for k in range(4):
        pairs[:, 2 * k] = np.cos(2 * np.pi * t) * (p.run == k)
        pairs[:, 2 * k + 1] = np.sin(2 * np.pi * t) * (p.run == k)
    beta = solve(np.where(p.train[:, None], pairs, 0.0), np.where(p.train, p.y, 0.0))
    with_phase = Model(x=pairs, beta=beta, phases=[slice(0, 8)]).residual(p, p.test)
    without = Model(x=pairs, beta=beta).residual(p, p.test)
    assert np.sqrt(np.mean(with_phase**2)) < 1e-9
    assert np.sqrt(np.mean(without**2)) == pytest.approx(1.5 / np.sqrt(2), rel=0.05)


@settings(max_examples=20, deadline=None)
@given(seed=SEEDS)
def test_sessions_in_turn_are_each_predicted_by_the_others(seed: int) -> None:
    rng = np.random.default_rng(seed)
    x, y = rng.standard_normal((400, 3)), rng.standard_normal(400)
    p = problem(y)
    p.session, p.turned = p.run, np.ones(400, dtype=bool)
    assert p.train.all() and p.test.all()
    expected = np.zeros(400)
    for k in range(4):
        mine = p.run == k
        expected[mine] = y[mine] - x[mine] @ np.linalg.lstsq(x[~mine], y[~mine], rcond=None)[0]
    assert Model(x=x, beta=np.zeros(3)).left_out(p) == pytest.approx(expected, abs=1e-9)


def test_a_session_in_turn_is_held_out_where_the_others_tell_its_terms() -> None:
    """The last session alone turns back: of the others, friction and offset are one column."""
    rng = np.random.default_rng(0)
    p = problem(rng.standard_normal(400))
    sign = np.where((p.run == 3) & (np.arange(400) % 2 == 0), -1.0, 1.0)
    p.session, p.base = p.run, np.column_stack([rng.standard_normal(400), sign, np.ones(400)])
    turned = p.in_turn()
    assert turned.train.all()
    assert (turned.test == (sign > 0)).all()


@settings(max_examples=20, deadline=None)
@given(seed=SEEDS)
def test_beside_nuisances_a_piece_is_told_by_the_others_alone(seed: int) -> None:
    """Against a least squares of every piece in turn, on what a projection leaves (Frisch, Waugh, Lovell)."""
    rng = np.random.default_rng(seed)
    n = 600
    base, x, y = np.vander(np.linspace(-1, 1, n), 4), rng.standard_normal((n, 2)), rng.standard_normal(n)
    p = problem(y, base)
    p.valid = rng.random(n) > 0.1
    p.session, p.turned, p.slow = np.arange(n) // 150, p.valid, True
    left = Model(x=np.hstack([base, x]), beta=np.zeros(6)).left_out(p)
    rows = p.valid
    away = np.eye(rows.sum()) - base[rows] @ np.linalg.pinv(base[rows])
    xs, ys, piece = away @ x[rows], away @ y[rows], p.session[rows]
    for k in range(4):
        beta = np.linalg.lstsq(xs[piece != k], ys[piece != k], rcond=None)[0]
        assert left[piece == k] == pytest.approx(ys[piece == k] - xs[piece == k] @ beta, abs=1e-9)
    assert Model(x=base, beta=np.ones(4)).left_out(p) == pytest.approx(ys, abs=1e-9)


def test_rows_that_the_others_do_not_tell_are_not_validated() -> None:
    """Two steps with one stretch between them, all of it in one fold: beside the others they are one step."""
    rng = np.random.default_rng(6)
    n = 4000
    p = problem(rng.standard_normal(n), runs=1, held=9)
    at = np.arange(n)
    edge = np.clip((at - 1010) / 4.0, 0.0, 1.0), np.clip((at - 1040) / 4.0, 0.0, 1.0)
    x = np.column_stack([np.ones(n), *edge])
    p = replace(p, y=p.y + x @ np.array([1.0, 10.0, -10.0]), valid=at != 1012)
    found = cross_validate(p, x[:, :1], x, PLAIN)
    assert found.after < 1.2
