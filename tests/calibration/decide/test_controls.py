"""Negative controls on columns that are made up: what each one tries, and when it is accepted."""

from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.decide.controls import TEETH, Wrong, controls, order_beside, tooth_more_or_less
from calibration.decide.scan import fit_with
from calibration.decide.selection import Selection
from calibration.decide.thresholds import FEWEST_HELD, REVERSIBLE, ROUNDING
from calibration.names.scene import Scene
from plant.gears import ORDERS
from tests.calibration.decide.made import line, problem, term

ROWS = 2400
RNG = np.random.default_rng(31)
A, B, C, LUCK = RNG.standard_normal((4, ROWS))
HELD = problem(A).held


def of(y: np.ndarray, *some: Candidate, base: np.ndarray | None = None, noise: float = 0.3) -> Selection:
    s = Selection.of(problem(y + noise * LUCK, base))
    found = [fit_with(s.problem, s.problem.base, c) for c in some]
    return s.keep([x for x in found if x is not None])


def one(name: str, x: np.ndarray, **more: Any) -> Candidate:
    return term(name, x[:, None], **more)


def none(_: int, c: Candidate) -> Sequence[Wrong]:
    return ()


def flipped(s: Selection) -> bool:
    (row,) = controls(s, none, reversed_time=False)
    return bool(row["accepted"])


def test_every_effect_has_its_controls_in_order_with_its_place() -> None:
    some = [
        one("brake_drag", A, stage="motor", harmonic=2, sign=1),
        one("cable_wrap", B),
    ]
    s = of(2 * A + B, *some)
    rows = controls(s, lambda k, c: [Wrong(what=f"{k} {c.name}", note="why not")])
    assert [r["what"] for r in rows] == [
        "time reversed (brake_drag on motor, harmonic 2)",
        "0 brake_drag",
        "sign flipped (brake_drag on motor, harmonic 2)",
        "time reversed (cable_wrap)",
        "1 cable_wrap",
        "sign flipped (cable_wrap)",
    ]
    places = [("brake_drag", "motor", 2)] * 3 + [("cable_wrap", None, None)] * 3
    assert [(r["name"], r["stage"], r["harmonic"]) for r in rows] == places
    assert not any(r["accepted"] for r in rows)
    assert ["note" in r for r in rows] == [False, True, False] * 2
    assert rows[1]["note"] == "why not"


@pytest.mark.parametrize("place", [0, 1, 2])
def test_a_version_that_fits_as_well_is_accepted_in_the_place_of_its_own_effect(place: int) -> None:
    some = [one("brake_drag", A), one("cable_wrap", B), one("unknown", C)]
    s = of(A + B + C, *some)

    def same(k: int, c: Candidate) -> Sequence[Wrong]:
        return [Wrong(what="", columns=(-c.columns if k == place else np.roll(c.columns, 700, axis=0)))]

    told = [r["accepted"] for r in controls(s, same, reversed_time=False) if not r["what"]]
    assert told == [k == place for k in range(3)]


@pytest.mark.parametrize("in_base", [False, True])
@pytest.mark.parametrize("share", [REVERSIBLE - 0.05, REVERSIBLE + 0.05])
def test_columns_that_read_mostly_the_same_backwards_are_no_test(share: float, in_base: bool) -> None:
    """Of an even part a and an odd part b, reversed, (a^2 - b^2)^2 lies along the column itself."""
    even, odd = A + A[::-1], B - B[::-1]
    even, odd = (x / np.linalg.norm(x) * np.sqrt(ROWS) for x in (even, odd))
    if in_base:  # what is known of the reversed column is a declared term
        x, base = A, np.sqrt(share) * A[::-1] / np.std(A) + np.sqrt(1 - share) * B / np.std(B)
    else:
        part = (1 + np.sqrt(share)) / 2
        x, base = np.sqrt(part) * even + np.sqrt(1 - part) * odd, np.zeros(ROWS)
    s = of(3 * x, one("brake_drag", x), base=base[:, None])
    row, _ = controls(s, none)
    assert row["what"] == "time reversed (brake_drag)" and not row["accepted"]
    assert ("note" in row) is (share > REVERSIBLE)


def against(fitted: float, gain: float, rows: int = 600, loud: float = 0.0) -> Selection:
    """An effect of size `fitted`; its turned sign takes `gain` of the mean square of held-out rows.

    There the log has -d times the effect, of unit mean square, in noise without part along it. `loud`: what
    declared terms alone would err by there, rms.
    """
    some = HELD & (np.cumsum(HELD) <= rows)
    effect, noise = np.where(some, 1.0, A), np.where(some, np.where(np.arange(ROWS) % 2, 1.0, -1.0), 0.0)
    base = np.where(some, loud * noise, B)
    x = np.where(some, effect, effect + base)
    y = np.where(some, 0.0, fitted * x)
    s = Selection.of(problem(y + 0.1 * np.where(some, 0.0, LUCK), base[:, None]))
    s.problem.valid &= some | ~HELD
    found = fit_with(s.problem, s.problem.base, one("brake_drag", x))
    assert found is not None
    size = float(found.fit.beta[1])
    square = 1.0
    d = (gain * square / size + size) / 2
    own = np.sqrt(square - d**2)
    s.problem.y = np.where(some, -d * effect + own * noise + found.fit.beta[0] * base, s.problem.y)
    return Selection.of(s.problem, [found])


@pytest.mark.parametrize(("gain", "accepted"), [(0.5 * ROUNDING, False), (2 * ROUNDING, True), (0.1, True)])
def test_a_turned_sign_is_accepted_where_it_leaves_less_by_more_than_rounding(
    gain: float, accepted: bool
) -> None:
    assert flipped(against(0.6, gain)) is accepted


@pytest.mark.parametrize(("loud", "accepted"), [(10.0, False), (7.5, True), (0.1, True)])
def test_rounding_is_of_what_the_declared_terms_leave_where_that_is_more(loud: float, accepted: bool) -> None:
    s = against(0.6, 20 * ROUNDING, loud=loud)
    assert (s.held.before**2 > 25) is not accepted
    assert flipped(s) is accepted


@pytest.mark.parametrize(("rows", "accepted"), [(FEWEST_HELD - 2, False), (FEWEST_HELD, True)])
def test_few_held_out_rows_accept_no_sign(rows: int, accepted: bool) -> None:
    s = against(0.6, 0.1, rows)
    assert s.problem.test.sum() == rows and flipped(s) is accepted


TURNS = np.linspace(0.0, 3.0, ROWS)


@pytest.mark.parametrize(
    ("stage", "teeth"), [("shaft1", 113), ("shaft2", 123), ("motor", 27), ("roller", 30)]
)
def test_a_gear_with_one_tooth_more_or_less_turns_as_often_per_tooth(stage: str, teeth: int) -> None:
    """Teeth pass as often, so the order of a wrong gear is in the ratio of the teeth."""
    assert TEETH[stage] == teeth
    first = line("motor_cogging", TURNS, ORDERS[stage], stage=stage)
    some = tooth_more_or_less(TURNS, 1e3)(0, first)
    assert [w.what for w in some] == [f"one tooth {w} on {stage} ({first.say()})" for w in ("more", "less")]
    for wrong, other in zip(some, (teeth + 1, teeth - 1), strict=True):
        expected = line("", TURNS, ORDERS[stage] * other / teeth).columns
        assert wrong.columns == pytest.approx(expected) and not wrong.note


@pytest.mark.parametrize(("span", "tells"), [(0.69, False), (0.7, True)])
def test_a_travel_that_the_lines_hardly_part_within_tells_no_tooth(span: float, tells: bool) -> None:
    """At as many cycles per turn as teeth, a tooth is one cycle per turn."""
    some = tooth_more_or_less(TURNS, span)(0, line("motor_cogging", TURNS, 113.0, stage="shaft1"))
    assert [w.columns is not None for w in some] == [tells, tells]
    assert [w.note for w in some] == ["" if tells else "this travel cannot tell one tooth from the next"] * 2
    if not tells:
        assert [w.what for w in some] == ["one tooth more on shaft1", "one tooth less on shaft1"]


def test_what_has_no_teeth_has_no_wrong_tooth() -> None:
    right = line("motor_cogging", TURNS, 113.0, stage="shaft1")
    others = [
        line("motor_cogging", TURNS, 113.0, stage="axis"),
        line("motor_cogging", TURNS, 113.0),
        term("motor_cogging", right.columns, stage="shaft1", order=113.0),
        term("motor_cogging", right.columns, stage="shaft1", kind="line"),
    ]
    wrong_of = tooth_more_or_less(TURNS, 3.0)
    assert len(wrong_of(0, right)) == 2
    assert [wrong_of(0, c) for c in others] == [[]] * 4
    assert tooth_more_or_less(None, 3.0)(0, right) == []


def beside(span: float = 3.0, turn: float | None = None) -> Callable[[int, Candidate], list[Wrong]]:
    """Of a log that lacks every third row of the balance, in two sessions."""
    rows = np.flatnonzero(np.arange(ROWS) % 3)
    view = SimpleNamespace(turn=turn, x=TURNS * (turn or 1.0), rows=rows)
    scene = cast(Scene, cast(Any, SimpleNamespace(span=span, view=view, turn=turn or 1.0)))
    p = problem(A[rows])
    p.session[len(rows) // 2 :] = 1
    return order_beside(Selection.of(p), scene)


@pytest.mark.parametrize("turn", [None, 360.0])
def test_a_wrong_order_lies_beyond_the_resolution_cell_and_short_of_the_second(turn: float | None) -> None:
    """A cell is one over the travel, of three turns here."""
    order, travel = 5.0, 3.0
    some = beside(travel * (turn or 1.0), turn)(0, line("motor_cogging", TURNS, order))
    assert len(some) == 2 and all("in place of 5 (motor_cogging)" in w.what for w in some)
    x = TURNS[np.arange(ROWS) % 3 > 0]
    for wrong, way in zip(some, (1.0, -1.0), strict=True):
        off = float(wrong.what.split()[1]) - order
        assert 1.0 < way * off * travel < 2.0
        assert wrong.columns == pytest.approx(line("", x, order + way * 1.5 / travel).columns, abs=1e-6)


def test_a_refined_order_is_the_lines_own() -> None:
    refined = line("motor_cogging", TURNS, 5.0, fixed={"order": (5.3, "1")})
    assert [w.what for w in beside()(0, refined)] == [
        "order 5.8 in place of 5.3 (motor_cogging)",
        "order 4.8 in place of 5.3 (motor_cogging)",
    ]


@pytest.mark.parametrize(("order", "count"), [(0.4, 1), (0.5, 1), (0.6, 2)])
def test_a_line_of_no_order_or_of_a_negative_one_is_not_tried(order: float, count: int) -> None:
    assert len(beside()(0, line("motor_cogging", TURNS, order))) == count


def test_a_phase_of_every_run_stays_one() -> None:
    for per_run, width in ((False, 2), (True, 4)):
        some = beside()(0, line("motor_cogging", TURNS, 5.0, per_run=per_run))
        assert [w.columns.shape[1] for w in some if w.columns is not None] == [width] * 2


def test_plain_lines_of_the_six_strongest_effects_are_tried_beside_their_order() -> None:
    wrong_of, plain = beside(), line("motor_cogging", TURNS, 5.0)
    assert [len(wrong_of(k, plain)) for k in range(8)] == [2] * 6 + [0] * 2
    others = [
        term("motor_cogging", plain.columns, order=5.0),
        term("motor_cogging", plain.columns, kind="line"),
        line("gravity_imbalance", TURNS, 1.0),  # fixed to the place: no order of its own
        line("motor_cogging", TURNS, 5.0, stage="motor"),  # all harmonics of it at once
    ]
    assert [wrong_of(0, c) for c in others] == [[]] * 4
    assert len(wrong_of(0, line("motor_cogging", TURNS, 5.0, stage="motor", harmonic=1))) == 2
    assert len(wrong_of(0, line("motor_cogging", TURNS, 5.0, harmonic=1))) == 2
