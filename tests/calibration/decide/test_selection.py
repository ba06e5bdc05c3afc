"""What a selection offers: its effects on other rows, without one, in a place; and the loop of the rules."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from calibration.balances.candidate import Candidate
from calibration.decide.drive import below_floor, dominant, harmful, of_the_steps, remainder, worth_little
from calibration.decide.energy import feeds_energy, negative
from calibration.decide.rules import each, leave_out, lesser_of_one_order, superfluous
from calibration.decide.scan import Contender, fit_with
from calibration.decide.selection import Selection
from calibration.statistics.whitening import Whitener
from tests.calibration.decide.made import line, problem, term

ROWS, NOISE = 2400, 0.3


def contender(s: Selection, c: Candidate) -> Contender:
    found = fit_with(s.problem, s.problem.base, c)
    assert found is not None
    return found


def of(sizes: dict[str, float], seed: int = 0) -> Selection:
    """Effects of these sizes, one random column each, all chosen."""
    rng = np.random.default_rng(seed)
    columns = {name: rng.standard_normal((ROWS, 1)) for name in sizes}
    y = sum(size * columns[name][:, 0] for name, size in sizes.items()) + NOISE * rng.standard_normal(ROWS)
    s = Selection.of(problem(np.asarray(y)))
    return s.keep([contender(s, term(name, x)) for name, x in columns.items()])


def test_sizes_residual_and_effects_are_those_of_the_joint_fit() -> None:
    s = of({"brake_drag": 2.0, "load_friction": -1.0})
    assert [float(s.sizes(k)[0]) for k in range(2)] == pytest.approx([2.0, -1.0], abs=0.05)
    assert [c.name for c, _ in s.fitted] == ["brake_drag", "load_friction"]
    rest = s.problem.y - s.problem.base @ s.after.beta[:1] - s.effect(0) - s.effect(1)
    assert s.residual() == pytest.approx(rest)
    assert s.covariance(0).shape == (1, 1) and s.covariance(0)[0, 0] > 0
    assert s.held.after == pytest.approx(NOISE, rel=0.1)
    assert s.problem.blocks == int(s.problem.train.sum() / s.problem.block)


def test_without_and_put_give_what_is_left_and_say_why() -> None:
    s = of({"brake_drag": 2.0, "load_friction": -1.0})
    less = s.without(1, "too small")
    assert [c.name for c in less.candidates] == ["brake_drag"] and [c.name for c in s.candidates] == [
        "brake_drag",
        "load_friction",
    ]
    assert [(r.what, r.why) for r in less.refused] == [("load_friction", "too small")] and s.refused == []
    assert s.without(0).refused == []
    assert less.held.after > s.held.after and less.held.before == s.held.before
    back = less.put(0, s.chosen[1])
    assert [c.name for c in back.candidates] == ["load_friction"]
    assert s.keep([]).held.share == 0.0


@pytest.mark.parametrize("scale", [0.1, 1.0, 10.0])
def test_an_effect_is_worth_the_share_that_it_takes_beside_the_others(scale: float) -> None:
    """Independent effects of 2 and -1 take 4 and 1 of the mean square, beside the noise."""
    one = of({"brake_drag": 2.0, "load_friction": -1.0})
    s = one.on(replace(one.problem, y=scale * one.problem.y))
    whole = 4.0 + 1.0 + NOISE**2
    assert s.worth == pytest.approx([4 / whole, 1 / whole], abs=0.05)
    assert s.fitted_square == pytest.approx((scale * NOISE) ** 2, rel=0.1)


def test_where_nothing_is_held_out_or_left_no_effect_is_worth_anything() -> None:
    s = of({"brake_drag": 2.0})
    assert s.on(replace(s.problem, held=np.zeros(ROWS, dtype=bool))).worth == [0.0]
    nothing = np.where(s.problem.held, 0.0, s.problem.y)
    p = replace(s.problem, y=nothing, base=np.where(s.problem.held[:, None], 0.0, s.problem.base))
    assert s.on(p).held.before == 0.0 and s.on(p).worth == [0.0]


def test_a_selection_that_nothing_was_offered_to_has_looked_at_nothing() -> None:
    s = Selection.of(problem(np.ones(ROWS)))
    assert (s.looked_at, s.statistic, s.scores.threshold) == (0, 0.0, 0.0)
    assert len(s.scores.value) == len(s.scores.surrogate_max) == 0


def test_the_same_effects_on_other_rows() -> None:
    s = of({"brake_drag": 2.0})
    p = replace(s.problem, valid=s.problem.valid & (np.arange(ROWS) % 7 != 0))
    there = s.on(p)
    assert there.after.rows < s.after.rows and there.problem is p
    assert float(there.sizes(0)[0]) == pytest.approx(2.0, abs=0.05)
    assert s.held_on(p).after == pytest.approx(NOISE, rel=0.15)


def test_a_rule_is_asked_again_after_everything_it_left_out() -> None:
    s = of({"a": 3.0, "b": 2.0, "c": 1.0})
    asked: list[list[str]] = []

    @each
    def small(s: Selection, k: int) -> str:
        asked.append([c.name for c in s.candidates])
        return "smaller than b" if abs(s.sizes(k)[0]) < 1.5 else ""

    left = leave_out(s, small)
    assert [c.name for c in left.candidates] == ["a", "b"]
    assert asked == [["a", "b", "c"], ["a", "b"], ["a", "b"]]
    assert [r.why for r in left.refused] == ["smaller than b"]


def test_what_hardly_adds_anything_is_left_out_and_what_does_stays() -> None:
    assert [
        c.name for c in leave_out(of({"brake_drag": 2.0, "cable_wrap": 0.0}), worth_little).candidates
    ] == ["brake_drag"]
    assert len(leave_out(of({"brake_drag": 2.0, "load_friction": 1.0}), worth_little, harmful).chosen) == 2


def test_a_small_name_beside_one_that_explains_nearly_all_is_its_remainder() -> None:
    large = of({"brake_drag": 5.0, "load_friction": 0.3})
    assert dominant(large) == "brake_drag"
    (refused,) = leave_out(large, remainder).refused
    assert refused.what == "load_friction" and "a remainder of brake_drag" in refused.why
    assert dominant(of({"brake_drag": 2.0, "load_friction": 2.0})) == ""


def test_without_held_out_rows_nothing_is_compared() -> None:
    s = of({"brake_drag": 2.0, "cable_wrap": 0.0})
    blind = s.on(replace(s.problem, held=np.zeros(ROWS, dtype=bool)))
    assert np.isnan(blind.held.after) and dominant(blind) == ""
    assert len(leave_out(blind, worth_little, remainder, harmful).chosen) == 2


def test_names_are_for_what_is_above_the_floor() -> None:
    faint, clear = of({"brake_drag": 0.05}), of({"brake_drag": 2.0})
    for s in (faint, clear):
        s.problem.floor = 10.0
    assert below_floor(faint) is not None  # most of what is left stays
    assert below_floor(clear) is None  # a coarse sensor's floor may hide it, and did not


@pytest.mark.parametrize("in_turn", [False, True])
def test_what_only_rows_that_coarse_steps_spoil_have_is_no_effect(in_turn: bool) -> None:
    """Every second row is spoilt; of two names the one goes that is worse on the others."""
    s = of({"brake_drag": 2.0, "load_friction": 0.0})
    clean = np.arange(ROWS) % 2 == 0
    for k, where, stays in ((0, clean, None), (1, ~clean, 1)):
        column = np.where(where, s.candidates[k].columns[:, 0], 0.0)
        y = 2.0 * column + NOISE * np.random.default_rng(9).standard_normal(ROWS)
        p = replace(s.problem, y=y, resolved=(clean, NOISE), session=s.problem.run)
        p = p.in_turn() if in_turn else p
        alone = Selection.of(p)
        alone = alone.keep([contender(alone, term(s.candidates[k].name, column[:, None]))])
        assert (of_the_steps(alone) is None) == (stays is None)


def test_of_two_names_at_one_order_the_lesser_goes_where_it_adds_little() -> None:
    turns = np.linspace(0, 40, ROWS)
    rng = np.random.default_rng(3)
    first, other = line("cogging", turns, 3.0), line("ripple", turns, 3.0)
    bent = replace(other, columns=other.columns * (1 + 0.05 * rng.standard_normal((ROWS, 1))))
    s = Selection.of(problem(2.0 * first.columns[:, 0] + NOISE * rng.standard_normal(ROWS)))
    s = s.keep([contender(s, first), contender(s, bent)])
    found = lesser_of_one_order(s)
    assert found is not None and found[0] == 1 and "cogging" in found[1]
    apart = replace(bent, order=3.1)
    assert lesser_of_one_order(s.put(1, replace(s.chosen[1], candidate=apart))) is None


@pytest.mark.parametrize(("size", "wrong"), [(-3.0, "inertia"), (3.0, ""), (-0.001, "")])
def test_a_mass_that_comes_out_negative_beyond_its_error_is_said(size: float, wrong: str) -> None:
    rng = np.random.default_rng(5)
    x = rng.standard_normal((ROWS, 1))
    p = problem(size * x[:, 0] + NOISE * rng.standard_normal(ROWS), base=x)
    p.base_labels = [("inertia", "kg m2")]
    assert negative(Selection.of(p), 2.0) == wrong


def test_a_candidate_moves_in_what_its_columns_depend_on_and_in_nothing_else() -> None:
    def shape(p: np.ndarray) -> np.ndarray:
        return np.full((4, 1), float(p[0]))

    fixed = {"start": (3.0, "s"), "depth": (1.0, "1")}
    c = term("change", shape(np.array([3.0])), fixed=fixed, shape=shape, steps=(0.5,))
    assert c.free == ["start"] and c.point.tolist() == [3.0]
    there = c.moved(np.array([7.0]))
    assert there.fixed == {"start": (7.0, "s"), "depth": (1.0, "1")} and there.columns[0, 0] == 7.0
    assert c.fixed == fixed


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), a=st.floats(-0.9, 0.9))
def test_filtered_rows_are_those_whose_past_is_valid(seed: int, a: float) -> None:
    rng = np.random.default_rng(seed)
    x, valid = rng.standard_normal((60, 2)), rng.random(60) > 0.2
    w = Whitener(np.array([a]))
    rows = np.flatnonzero(valid[1:] & valid[:-1]) + 1
    assert w.whiten(x, valid) == pytest.approx(x[rows] - a * x[rows - 1])
    assert w.whiten(x[:, 0], valid) == pytest.approx((x[rows] - a * x[rows - 1])[:, 0])


def test_names_stay_for_fitted_rows_far_above_the_floor() -> None:
    """What begins and ends within the fitted rows shows on none that are held out."""
    s = of({"brake_drag": 2.0})
    fitted = np.where(s.problem.held[:, None], 0.0, s.candidates[0].columns)
    y = 2.0 * fitted[:, 0] + NOISE * np.random.default_rng(4).standard_normal(ROWS)
    for floor, goes in ((1.5 * NOISE, False), (8 * NOISE, True)):
        bare = Selection.of(replace(s.problem, y=y, floor=floor))
        assert bare.held.before < floor or goes is None
        one = bare.keep([contender(bare, term("brake_drag", fitted))])
        assert (below_floor(one) is not None) == goes


def test_what_takes_most_of_the_held_out_square_is_not_superfluous() -> None:
    """Of either first pick two fitted rows say hardly anything; one is all that held-out rows have."""
    held = problem(np.zeros(ROWS)).held
    shown = held | np.isin(np.arange(ROWS), [700, 900])
    column = np.where(shown, 1.0, 0.0)[:, None]
    later = np.random.default_rng(1).standard_normal((ROWS, 1))
    for size, kept in ((0.5, True), (0.0, False)):
        y = size * column[:, 0] + later[:, 0] + NOISE * np.random.default_rng(2).standard_normal(ROWS)
        s = Selection.of(replace(problem(y), ar_order=0))
        s = s.keep([contender(s, term("cable_wrap", column)), contender(s, term("brake_drag", later))])
        assert (superfluous(s) is None) == kept


def test_friction_that_is_surely_negative_feeds_energy() -> None:
    """It was within its error before the name; with the name it is not."""
    rng = np.random.default_rng(8)
    way, load = rng.choice([-1.0, 1.0], ROWS), rng.standard_normal(ROWS)
    shape = way * (1.0 + 0.02 * load)
    y = -5.0 * way + 5.0 * shape + NOISE * rng.standard_normal(ROWS)
    p = replace(problem(y, way[:, None]), base_labels=[("coulomb", "N m")])
    s = Selection.of(p)
    assert abs(s.before.beta[0]) < 3 * s.before.errors[0]
    s = s.keep([contender(s, term("friction_warmup", shape[:, None]))])
    assert s.after.beta[0] < -3 * s.after.errors[0]
    found = feeds_energy(s)
    assert found is not None and "feeds energy" in found[1]
