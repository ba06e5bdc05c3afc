"""Held-out scores: who is compared on which rows, against closed forms."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from calibration.balances.frame import Frame
from calibration.decide.heldout import (
    HeldOut,
    Model,
    choose_held_out,
    compare,
    cross_validate,
    folds,
    paired_z,
)
from calibration.decide.thresholds import FEWEST_HELD, FEWEST_VALIDATED, FOLDS, ROUNDING
from calibration.statistics.regression import solve
from calibration.statistics.whitening import Whitener
from tests.calibration.decide.made import PERIOD_S, problem

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


def test_nothing_that_was_compared_is_no_gain() -> None:
    none = HeldOut()
    assert (none.z, none.share, none.everywhere, none.apart, none.sure) == (0.0, 0.0, False, False, False)
    assert np.isnan(none.before) and np.isnan(none.after)
    assert HeldOut(before=3.0, after=2.0).taken == 5.0


@pytest.mark.parametrize(
    ("z", "share", "sure"), [(9.0, 0.5, True), (2.0, 0.5, False), (9.0, ROUNDING, False), (-9.0, 0.5, False)]
)
def test_a_gain_is_sure_beyond_luck_and_rounding(z: float, share: float, sure: bool) -> None:
    assert HeldOut(z=z, share=share).sure is sure


def test_the_fewest_rows_are_compared_and_their_z_is_that_of_the_squares() -> None:
    y, x = np.random.default_rng(1).standard_normal((2, 400))
    one, other = Model(x=x[:, None], beta=np.zeros(1)), Model(x=x[:, None], beta=np.array([0.3]))
    p = problem(y + x)
    p.held = np.arange(400) < FEWEST_HELD
    found = compare(p, one, other, PLAIN)
    left = [(p.y - m.x @ m.beta)[p.test] for m in (one, other)]
    assert found.before == pytest.approx(np.sqrt(np.mean(left[0] ** 2)))
    assert found.apart and not found.everywhere
    assert found.z == pytest.approx(paired_z(left[0] ** 2 - left[1] ** 2, p.block)) and found.z > 0
    coloured = Whitener(np.array([0.5]))
    white = [e[1:] - 0.5 * e[:-1] for e in left]
    whitened = compare(p, one, other, coloured).z
    assert whitened == pytest.approx(paired_z(white[0] ** 2 - white[1] ** 2, p.block))
    p.session, p.turned = p.run, np.ones(400, dtype=bool)
    assert not compare(p, one, other, PLAIN).apart


def test_nothing_is_taken_off_nothing() -> None:
    p = problem(np.zeros(400))
    model = Model(x=np.ones((400, 1)), beta=np.zeros(1))
    found = compare(p, model, model, PLAIN)
    assert (found.before, found.share, found.z) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("rows", "block", "size"), [(600, 20, 20), (40, 20, 20), (39, 20, 9), (7, 20, 1), (3, 20, 1), (2, 20, 1)]
)
def test_a_z_is_students_over_blocks_of_a_quarter_where_there_would_be_one(
    rows: int, block: int, size: int
) -> None:
    gain = np.random.default_rng(rows).standard_normal(rows) + 2.0
    sums = np.array([gain[k : k + size].sum() for k in range(0, rows, size)])
    expected = stats.ttest_1samp(sums, 0.0).statistic
    assert paired_z(gain, block) == pytest.approx(expected)


def test_no_gain_of_one_row_or_none_is_told() -> None:
    assert paired_z(np.zeros(0), 20) == paired_z(np.array([3.0]), 20) == 0.0


def test_a_new_segments_offset_alone_is_fitted_anew() -> None:
    """Without such a column nothing of the held-out rows is fitted."""
    x = np.random.default_rng(5).standard_normal((400, 1))
    p = problem(2.0 * x[:, 0] + 50.0)
    left = Model(x=x, beta=np.array([2.0])).residual(p, p.test)
    assert left == pytest.approx(np.full(p.test.sum(), 50.0))


@pytest.mark.parametrize("size", [0.01, 1.0])
def test_every_harmonics_own_size_is_kept_as_its_phase_is_fitted(size: float) -> None:
    """Of three fitted runs the middle one's size counts; a harmonic that none of them has is left."""
    t = np.arange(800) / 40.0
    p = problem(np.zeros(800))
    pairs = np.zeros((800, 20))
    for run in range(4):
        for h, turns in enumerate((t, 2 * t)):
            at, mine = 4 * run + 2 * h, p.run == run
            pairs[:, at] = np.cos(2 * np.pi * turns) * mine
            pairs[:, at + 1] = np.sin(2 * np.pi * turns) * mine
    pairs[:, 16] = np.cos(2 * np.pi * 3 * t) * (p.run == 3)
    pairs[:, 17] = np.sin(2 * np.pi * 3 * t) * (p.run == 3)
    beta = np.zeros(20)
    beta[[0, 4, 8]] = size * np.array([1.0, 1.5, 9.0])
    beta[[3, 7, 11]] = size * np.array([0.2, 0.5, 0.4])
    first, second = np.cos(2 * np.pi * t + 1.0), np.cos(2 * np.pi * 2 * t - 2.0)
    third = np.cos(2 * np.pi * 3 * t)
    p.y = np.where(p.run == 3, size * (1.7 * first + 0.3 * second + 2.0 * third), 0.0)
    left = Model(x=pairs, beta=beta, phases=[slice(0, 20)]).residual(p, p.test)
    expected = size * ((1.7 - 1.5) * first + (0.3 - 0.4) * second + 2.0 * third)[p.test]
    assert left == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("seconds", [60.0, 20.0, 2.0])
def test_a_fold_has_pieces_in_turn_and_every_run_begins_with_the_next(seconds: float) -> None:
    """Six seconds each, or as short as to make ten pieces of all runs, but of eight rows at least."""
    rows = round(seconds / PERIOD_S)
    for runs in (1, 3):
        p = problem(np.zeros(rows * runs), runs=runs, held=9)
        longest = min(120, rows * runs // 10)
        piece, run = np.arange(rows * runs) % rows // max(longest, 8), np.arange(rows * runs) // rows
        assert (folds(p, p.train) == (piece + run) % FOLDS).all()


def test_pieces_that_are_not_used_are_not_dealt() -> None:
    p = problem(np.zeros(2400), runs=2, held=9)
    used = (np.arange(2400) // 120 % 10 < 3) | (np.arange(2400) // 120 % 10 > 5)
    piece, run = np.arange(2400) // 120 % 10, np.arange(2400) // 1200
    expected = (np.where(piece > 5, piece - 3, piece) + run) % FOLDS
    assert (folds(p, used) == expected[used]).all()


@pytest.mark.parametrize("size", [1.0, -1.0, 0.02])
def test_a_validation_is_that_of_its_folds_by_least_squares(size: float) -> None:
    rng = np.random.default_rng(7)
    x, y = rng.standard_normal((1200, 2)), rng.standard_normal(1200)
    p = problem(y + size * x[:, 1], held=9)
    found = cross_validate(p, x[:, :1], x, PLAIN)
    fold, left = folds(p, p.train), []
    for some in (x[:, :1], x):
        e = np.zeros(1200)
        for k in range(FOLDS):
            out = fold == k
            e[out] = p.y[out] - some[out] @ np.linalg.lstsq(some[~out], p.y[~out], rcond=None)[0]
        left.append(e)
    gain = left[0] ** 2 - left[1] ** 2
    assert (found.before, found.after) == pytest.approx(tuple(np.sqrt(np.mean(e**2)) for e in left))
    assert found.z == pytest.approx(paired_z(gain, p.block))
    assert found.everywhere is all(gain[fold == k].sum() > 0 for k in range(FOLDS))
    assert found.everywhere is (abs(size) > 0.5)


def test_a_gain_that_one_fold_lacks_is_not_everywhere() -> None:
    x, y = np.random.default_rng(12).standard_normal((2, 1200))
    p = problem(y, held=9)
    p.y = y + np.where(folds(p, p.train) == 3, 0.0, x)
    base = np.ones((1200, 1))
    found = cross_validate(p, base, np.column_stack([base, x]), PLAIN)
    assert found.z > 2 and found.share > 0.1 and not found.everywhere


def test_pieces_that_one_run_lacks_are_dealt_to_its_others_in_turn() -> None:
    """The second run has its first and third piece alone, whatever the first one has."""
    p = problem(np.zeros(2400), runs=2, held=9)
    piece, run = np.arange(2400) // 120 % 10, np.arange(2400) // 1200
    used = (run == 0) | (piece == 0) | (piece == 2) | (piece == 9)
    rank = np.where(run == 0, piece, np.where(piece == 9, 2, piece // 2))
    assert (folds(p, used) == ((rank + run) % FOLDS)[used]).all()


def test_a_column_that_one_fold_alone_has_gains_not_in_every_fold() -> None:
    """It is told by the others nowhere; a column that is nothing gains nothing in any."""
    x, y = np.random.default_rng(8).standard_normal((2, 1200))
    p = problem(y, held=9)
    base = np.ones((1200, 1))
    same = cross_validate(p, base, np.column_stack([base, np.zeros(1200)]), PLAIN)
    assert same.share == pytest.approx(0.0) and not same.everywhere
    small = problem(1e-3 * (y + x), held=9)
    assert cross_validate(small, base, np.column_stack([base, x]), PLAIN).everywhere


@pytest.mark.parametrize(("rows", "told"), [(FEWEST_VALIDATED, True), (FEWEST_VALIDATED - 1, False)])
def test_few_rows_validate_nothing(rows: int, told: bool) -> None:
    x, y = np.random.default_rng(9).standard_normal((2, 400))
    p = problem(y + x, held=9)
    p.valid = np.arange(400) < rows
    found = cross_validate(p, np.ones((400, 1)), np.column_stack([np.ones(400), x]), PLAIN)
    assert np.isfinite(found.before) is np.bool_(told)
    # rows that the others do not tell are none
    alone = np.where(np.arange(400) < 8, x, 0.0)  # of the first piece, and its fold's
    p.valid = np.arange(400) < rows + 8
    untold = cross_validate(p, np.ones((400, 1)), np.column_stack([np.ones(400), alone]), PLAIN)
    assert np.isfinite(untold.before) is np.bool_(told)


@pytest.mark.parametrize(("alone", "told"), [(FOLDS - 1, False), (FOLDS - 2, True)])
def test_what_the_others_tell_in_one_fold_only_is_validated_in_none(alone: int, told: bool) -> None:
    """So many folds have a column each that the others lack."""
    p = problem(np.random.default_rng(10).standard_normal(1200), held=9)
    fold, base = folds(p, p.train), np.ones((1200, 1))
    own = np.column_stack([fold == k for k in range(alone)]).astype(float)
    found = cross_validate(p, base, np.hstack([base, own]), PLAIN)
    assert np.isfinite(found.before) is np.bool_(told)


def frame(*speeds: float, sessions: str = "", loops: str = "", rows: int = 100) -> Frame:
    """Runs of these speeds, 2 s a row; a letter of each one's session, c where its loop is closed."""

    def run(k: int) -> SimpleNamespace:
        header = {"loop": "closed" if loops[k : k + 1] == "c" else "open"}
        session = sessions[k : k + 1] or str(k)
        return SimpleNamespace(name=f"r{k}", session=session, header=header, among=lambda n: f"r{k}" in n)

    label = np.repeat(np.arange(len(speeds)), rows)
    position = np.concatenate([v * np.arange(rows) for v in speeds])
    made = SimpleNamespace(
        runs=[run(k) for k in range(len(speeds))], run=label, columns={"position": position},
        t=100.0 + 2.0 * np.arange(len(label)),
    )  # fmt: skip
    return cast(Frame, cast(Any, made))


@pytest.mark.parametrize(
    ("speeds", "sessions", "loops", "chosen"),
    [
        ((3.0, 1.0, 2.0), "", "", 2),
        ((3.0, -1.0, -2.0), "", "", 2),
        ((2.0, 3.0, 1.0), "", "", 0),
        ((1.0, 3.0, 2.0, 4.0), "", "", 2),  # of those that the others cover the last
        ((1.0, 3.0, 2.0, 4.0), "", "cc", 1),  # a closed one
        ((1.0, 3.0, 2.0, 4.0), "", "c", 2),  # which the others cover
        ((1.0, 3.0, 2.0, 4.0), "aabc", "", 1),  # of a session that has another run
        ((1.0, 3.0, 2.0, 4.0), "aabc", "occ", 1),
        ((1.0, 3.0, 2.0, 4.0), "aabc", "ooc", 2),
    ],
)
def test_a_run_whose_speeds_the_others_cover_is_held_out(
    speeds: tuple[float, ...], sessions: str, loops: str, chosen: int
) -> None:
    f = frame(*speeds, sessions=sessions, loops=loops)
    held, names = choose_held_out(f, [])
    assert names == [f"r{chosen}"] and (held == (f.run == chosen)).all()


def test_runs_that_are_named_are_held_out_however_few_there_are() -> None:
    for speeds in ((1.0, 2.0), (3.0, 1.0, 2.0, 5.0)):
        f = frame(*speeds)
        held, names = choose_held_out(f, ["r0", "r1"])
        assert names == ["r0", "r1"] and (held == (f.run < 2)).all()


def test_of_fewer_than_three_runs_the_ends_are_held_out() -> None:
    for speeds in ((1.0,), (1.0, 2.0)):
        f = frame(*speeds, rows=20)
        held, names = choose_held_out(f, [])
        assert (held == (np.arange(len(held)) % 20 >= 14)).all()
        assert names == [f"r{k} from 28 s" for k in range(len(speeds))]
