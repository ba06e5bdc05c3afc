"""The rules of leaving out, on columns that are made up: bounds, signs, energy, cancelling, orders."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.decide import drive
from calibration.decide.drive import (
    below_floor,
    cancelling,
    larger_than_the_response,
    of_the_steps,
    within_bounds,
)
from calibration.decide.energy import feeds_energy, negative, signed
from calibration.decide.rules import lesser_of_one_order, needless, superfluous
from calibration.decide.scan import fit_with
from calibration.decide.selection import Selection
from calibration.finding import UNKNOWN, Parameter
from tests.calibration.decide.made import line, problem, term

ROWS, NOISE = 2400, 0.3
RNG = np.random.default_rng(23)
A, B, C, LUCK = RNG.standard_normal((4, ROWS))


def of(y: np.ndarray, *some: Candidate, **more: Any) -> Selection:
    """All of these effects, each as it was fitted alone, whatever its sign."""
    s = Selection.of(replace(problem(y + NOISE * LUCK), **more))
    found = [fit_with(s.problem, s.problem.base, replace(c, sign=0, most=np.inf)) for c in some]
    return s.keep([replace(x, candidate=c) for x, c in zip(found, some, strict=True) if x is not None])


def one(name: str, x: np.ndarray, **more: Any) -> Candidate:
    return term(name, x.reshape(ROWS, -1), **more)


def test_a_first_pick_goes_where_later_ones_hold_it() -> None:
    assert superfluous(of(A + B, one("x", A + B), one("a", A), one("b", B)))[0] == 0  # type: ignore[index]
    assert superfluous(of(2 * A + B, one("a", A), one("x", A + B))) is None
    assert superfluous(of(A + B + C, one("c", C), one("x", A + B), one("a", A), one("b", B)))[0] == 1  # type: ignore


def test_a_pick_whose_sign_the_others_turn_is_superfluous() -> None:
    why = "superfluous once the others are in"
    assert superfluous(of(A - 0.1 * C, one("c", C, sign=1), one("a", A))) == (0, why)


@pytest.mark.parametrize("size", [0.0, 1.0])
def test_a_function_without_a_name_stays_where_it_is_accepted_beside_the_others(size: float) -> None:
    unnamed, drag = one(UNKNOWN, B), one("brake_drag", A)
    found = needless(0.05)(of(2 * A + size * B, drag, unnamed))
    assert (found is None) == (size > 0)
    assert found is None or (found[0], found[1][:18]) == (1, "beside the others:")
    refused = needless(0.05)(of(2 * A - size * B, drag, replace(unnamed, sign=1)))
    assert size == 0.0 or refused == (1, "beside the others: cannot be determined")
    assert needless(0.05)(of(2 * A, drag, one("play", B))) is None  # it has a name
    assert needless(0.05)(of(0 * A, unnamed)) is None  # nothing stands beside it
    three = needless(0.05)(of(2 * A + C, drag, unnamed, one("play", C)))
    assert three is not None and three[0] == 1


def test_only_of_two_names_at_one_order_the_lesser_goes() -> None:
    turns = np.linspace(0, 40, ROWS)
    first, other = line("motor_cogging", turns, 3.0), line("torque_ripple", turns, 3.0)
    other = replace(other, columns=other.columns * (1 + 0.05 * A[:, None]))
    y = 2.0 * first.columns[:, 0]
    assert lesser_of_one_order(of(y, other, first))[0] == 0  # type: ignore[index]
    assert lesser_of_one_order(of(y, one("brake_drag", B), other, first))[0] == 1  # type: ignore[index]
    assert lesser_of_one_order(of(y, replace(other, order=None), first)) is None
    assert lesser_of_one_order(of(y, replace(other, name=first.name), first)) is None
    # both are there, the second with a quarter of the first one's square: no shape leaves as much
    apart = replace(other, columns=line("", turns, 5.0).columns)
    both = y + apart.columns[:, 0]
    s = of(both, apart, first)
    assert lesser_of_one_order(s) is None
    assert lesser_of_one_order(s.on(replace(s.problem, y=1e-6 * s.problem.y))) is None  # in another unit


BOUNDS = {
    "width": Parameter(1.0, "deg", -0.1, 2.0),
    "order": Parameter(1.0, "1", -0.1, 2.0),
    "damping": Parameter(0.5, "1", 0.4, 1.5),
}


@pytest.mark.parametrize("name", BOUNDS)
def test_a_shape_of_no_width_no_order_or_no_resonance_goes(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    s = of(A, one("damaged_tooth", A))
    told: dict[str, Parameter] = {}
    monkeypatch.setattr(drive, "parameters_of", lambda s, k: told)
    assert within_bounds(0.1)(s) is None
    told[name] = BOUNDS[name]
    words = {"width": "as wide as nothing", "order": "of any order", "damping": "no damping of a resonance"}
    assert within_bounds(0.1)(s)[1].startswith(words[name])  # type: ignore[index]
    low = 0.01 if name == "damping" else 0.0
    told[name] = Parameter(0.02, "1", low, 0.05)
    assert within_bounds(0.1)(s) is None
    told[name] = Parameter(0.02, "1")  # of a grid: no interval
    assert within_bounds(0.1)(s) is None


@pytest.mark.parametrize(("gap", "goes"), [(0.1, True), (0.11, False)])
def test_a_gap_within_the_sensors_steps_goes(gap: float, goes: bool) -> None:
    s = of(A, one("play", A, fixed={"gap": (gap, "deg")}))
    assert within_bounds(0.1)(s) == ((0, "narrower than the sensor's steps show") if goes else None)


def test_an_effect_larger_than_the_response_that_leaves_more_than_there_was_goes() -> None:
    """Of A and nearly A, 20 and -20 times: each alone is far larger than what they make together."""
    two = 20 * A - 20 * (A + 0.05 * B)
    near = [one("brake_drag", A), one("load_friction", A + 0.05 * B)]
    s = of(two, *near)
    assert larger_than_the_response(s, 0) and larger_than_the_response(s, 1)
    assert within_bounds(0.1)(s)[1].startswith("larger than the response's own range")  # type: ignore[index]
    assert larger_than_the_response(of(two, replace(near[0], name=UNKNOWN), near[1]), 0)
    assert not larger_than_the_response(of(two, replace(near[0], name="play"), near[1]), 0)  # a loop
    # as large as all there is, and leaves less: a true effect
    assert not larger_than_the_response(of(3 * A, near[0]), 0)
    assert not larger_than_the_response(of(A, one("brake_drag", A), one("play", B)), 1)


def test_a_second_mass_is_a_part_of_the_inertia() -> None:
    mass = one("structural_mode", B, fixed={"damping": (0.02, "1")})
    labels = [("inertia", "kg m2")]
    for size, larger in ((0.5, False), (2.0, True)):
        assert (
            larger_than_the_response(of(A + size * B, mass, base=A[:, None], base_labels=labels), 0) is larger
        )
    assert not larger_than_the_response(of(A + 2 * B, mass, base=A[:, None]), 0)
    plain = replace(mass, fixed={})
    assert not larger_than_the_response(of(A + 2 * B, plain, base=A[:, None], base_labels=labels), 0)


def test_a_harmonic_of_a_line_is_judged_as_a_pair() -> None:
    turns = np.linspace(0, 40, ROWS)
    pair = line("torque_ripple", turns, 1.0)
    near = replace(pair, name="motor_cogging", columns=pair.columns + 0.05 * np.column_stack([A, B]))
    s = of(20 * (pair.columns - near.columns).sum(axis=1), pair, near)
    assert larger_than_the_response(s, 0)
    assert not larger_than_the_response(of(pair.columns.sum(axis=1), pair), 0)
    third = line("", turns, 3.0).columns
    two = [replace(c, columns=np.hstack([third, c.columns])) for c in (pair, near)]
    assert larger_than_the_response(of(s.problem.y, *two), 0)


@pytest.mark.parametrize(("share", "pair"), [(0.4, (0, 2)), (0.6, None)])
def test_two_that_leave_less_than_half_of_the_lesser_cancel(
    share: float, pair: tuple[int, int] | None
) -> None:
    """A against -A + share B: of B's part alone is left, on fitted rows."""
    s = of(10 * A - 10 * (A - share * B) + 3 * C, one("x", A), one("c", C), one("y", A - share * B))
    left = 10 * share / (10 * np.hypot(1, share) if share > 1 else 10)
    assert (left < 0.5) == (pair is not None)
    assert cancelling(s) == pair


@pytest.mark.parametrize(
    ("size", "errors", "wrong"), [(-1.0, 1.0, "viscous"), (1.0, 1.0, ""), (-1.0, 1e6, "")]
)
def test_the_first_declared_term_that_is_negative_is_said(size: float, errors: float, wrong: str) -> None:
    base = np.column_stack([C, A, B])
    labels = [("offset", "N m"), ("viscous", "N m s"), ("coulomb", "N m")]
    assert negative(of(-C + size * A + B, base=base, base_labels=labels), errors) == wrong
    if errors == 1.0 and size < 0:
        assert negative(of(-C + size * A + B, base=base, base_labels=labels)) == wrong


def test_a_term_that_is_negative_by_half_its_error_is_so_but_not_beyond_it() -> None:
    labels = [("viscous", "N m s")]
    fit = of(0 * A, base=A[:, None], base_labels=labels).before
    s = of(-(fit.beta[0] + 0.5 * fit.errors[0]) * A, base=A[:, None], base_labels=labels)
    assert (negative(s), negative(s, 1.0)) == ("viscous", "")


def test_parts_of_the_wrong_sign_go_and_the_others_stay() -> None:
    two = term("friction_asymmetry", np.column_stack([A, B]), sign=1)
    s = signed(of(A - B, two))
    assert [c.labels for c in s.candidates] == [(("size_0", "N m"),)] and s.sizes(0) == pytest.approx(
        [1.0], abs=0.05
    )
    assert signed(of(0.5 * A - B, two)).sizes(0) == pytest.approx([0.5], abs=0.05)
    gone = signed(of(-A - B, two))
    assert not gone.chosen and "a sign that physics excludes" in gone.refused[0].why
    together = replace(two, labels=two.labels[:1])  # one label of both: no part of its own
    assert not signed(of(A - B, together)).chosen
    both = signed(of(A - B - C, two, one("brake_drag", C, sign=1)))
    assert [(c.name, c.width) for c in both.candidates] == [("friction_asymmetry", 1)]
    assert len(signed(of(A + B + C, two, one("brake_drag", C, sign=1))).chosen) == 2


def test_a_part_of_a_shape_moves_as_the_whole_did() -> None:
    def shape(p: np.ndarray) -> np.ndarray:
        return np.column_stack([A * p[0], B])

    two = replace(
        term("a", shape(np.ones(1)), sign=1), fixed={"scale": (1.0, "1")}, shape=shape, steps=(0.1,)
    )
    (c,) = signed(of(A - B, two)).candidates
    assert c.moved(np.array([2.0])).columns == pytest.approx(2 * A[:, None])


def energy(
    size: float, name: str = "coulomb", first: bool = False, friction: float = 3.0, late: float = 1.0
) -> Selection:
    """Declared friction of 3 A; fitted rows alone have half of `size` times B, as A + B / 2 less A would."""
    held = problem(A).held
    some = [one("play", C), one("brake_drag", A + 0.5 * B)]
    y = (
        friction * A
        + np.where(held, 0.0, 0.5 * size * B)
        + np.where(held, late, max(late, 3.0 - 2 * late)) * C
    )
    return of(y, *(some[::-1] if first else some), base=A[:, None], base_labels=[(name, "N m")])


@pytest.mark.parametrize("first", [False, True])
def test_the_name_beside_which_friction_turns_negative_goes(first: bool) -> None:
    found = feeds_energy(energy(5.0, first=first))
    assert found == (0 if first else 1, "beside it coulomb comes out negative, which feeds energy")
    assert feeds_energy(energy(2.0)) is None and feeds_energy(energy(5.0, "offset")) is None
    assert feeds_energy(energy(5.0, friction=-3.0)) is None  # it was so before
    # of play, which held-out rows do not have, less is left; but without it friction stays negative
    one_less = feeds_energy(energy(3.5, first=first, late=0.0))
    assert one_less is not None and one_less[0] == (0 if first else 1)


def test_none_goes_where_all_with_a_term_of_zero_leave_less() -> None:
    """Friction comes out just negative by noise; without the effect far more is left."""
    effect, base = one("brake_drag", A + 2 * B), A[:, None]
    y = -0.02 * A + 3 * (A + 2 * B)
    s = of(y, effect, base=base, base_labels=[("coulomb", "N m")])
    assert s.before.beta[0] > 0 > s.after.beta[0]
    assert feeds_energy(s) is None


@pytest.mark.parametrize(
    ("friction", "wave", "turns"),
    [(2.0, 3.0, True), (2.0, 1.0, False), (0.5, 0.75, True), (1.0, 1.0, False), (0.5, 0.1, False)],
)
def test_friction_of_the_place_that_is_larger_than_friction_feeds_energy(
    friction: float, wave: float, turns: bool
) -> None:
    way = np.sign(A)
    pair = line("position_friction", np.linspace(0, 40, ROWS), 1.0)
    pair = replace(pair, columns=pair.columns * way[:, None])
    y = friction * way + wave * pair.columns[:, 0]
    why = "beside it friction at some places comes out negative, which feeds energy"
    friction_of_place = ("position_friction", "coulomb")
    for name, term_name in (friction_of_place, ("torque_ripple", "coulomb"), ("position_friction", "offset")):
        s = of(y, replace(pair, name=name), base=way[:, None], base_labels=[(term_name, "N m")])
        told = turns and (name, term_name) == friction_of_place
        assert feeds_energy(s) == ((0, why) if told else None)


@pytest.mark.parametrize(
    ("friction", "more", "turns"), [(2.0, 3.0, True), (2.0, -3.0, True), (2.0, 1.0, False)]
)
def test_friction_that_one_way_pushes_feeds_energy(friction: float, more: float, turns: bool) -> None:
    way, size = np.sign(A), np.abs(np.tanh(A))
    s = of(
        friction * way + more * size,
        replace(one("friction_asymmetry", size), labels=(("coulomb_asymmetry", "N m"),)),
        base=way[:, None],
        base_labels=[("coulomb", "N m")],
    )
    why = "beside it friction one way comes out negative, which feeds energy"
    assert feeds_energy(s) == ((0, why) if turns else None)


@pytest.mark.parametrize(
    ("found", "known", "turns"), [(0.0, 0.0, True), (2.0, 0.0, False), (0.0, 2.0, False)]
)
def test_friction_of_the_place_needs_friction_that_is_declared_known_or_found(
    found: float, known: float, turns: bool
) -> None:
    way = np.sign(A)
    pair = line("position_friction", np.linspace(0, 40, ROWS), 1.0)
    pair = replace(pair, columns=pair.columns * way[:, None])
    more = [one("coulomb_change", way)] if found else []
    y = A + found * way + pair.columns[:, 0]
    s = of(y, pair, *more, base=A[:, None], base_labels=[("viscous", "N m s")], known={"coulomb": known})
    assert (feeds_energy(s) is not None) == turns


CLEAN = np.arange(ROWS) // 50 % 2 == 0  # in stretches, so that the noise's filter has their past


@pytest.mark.parametrize(
    ("size", "noise", "kept"), [(2.0, NOISE, True), (2.0, 10.0, False), (0.2, 0.1, False)]
)
def test_below_the_floor_names_stay_that_rows_off_the_steps_need(
    size: float, noise: float, kept: bool
) -> None:
    """Spoilt rows are so loud that no half of all goes with the name; of clean rows most does."""
    y = size * A + np.where(CLEAN, 0.0, 10 * B)
    s = of(y, one("brake_drag", A), floor=20.0, resolved=(CLEAN, noise))
    assert not drive.clear(s) and s.held.before < 20.0
    assert (below_floor(s) is None) == kept
    assert below_floor(of(y, one("brake_drag", A), floor=20.0)) is not None
    few = CLEAN & ~s.problem.held
    assert below_floor(of(y, one("brake_drag", A), floor=20.0, resolved=(few, noise))) is not None


def test_of_two_names_the_one_goes_that_clean_rows_do_not_need() -> None:
    """Rows off the steps do not have the first one, whose size comes from spoilt rows."""
    y = np.where(CLEAN, 0.0, B + C)
    some = [one("load_friction", np.where(CLEAN, A, C)), one("brake_drag", np.where(CLEAN, 0.0, B))]
    for k in (0, 1):
        found = of_the_steps(of(y, some[k], some[1 - k], resolved=(CLEAN, NOISE)))
        assert found == (k, "only rows that the position's steps spoil have it")
    assert of_the_steps(of(y, *some)) is None
    assert of_the_steps(of(y + 2 * A, one("brake_drag", A), resolved=(CLEAN, NOISE))) is None
    few = np.isin(np.arange(ROWS), np.flatnonzero(problem(A).held)[:59]) | ~problem(A).held
    assert of_the_steps(of(y, one("brake_drag", B), resolved=(few, NOISE))) is None
    more = np.isin(np.arange(ROWS), np.flatnonzero(problem(A).held)[:60]) | ~problem(A).held
    assert of_the_steps(of(0 * A, one("brake_drag", B), resolved=(more, NOISE))) is not None
