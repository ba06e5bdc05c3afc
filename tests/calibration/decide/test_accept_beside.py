"""Contenders beside what was chosen: how small is too small, what ties, and scores that are just enough."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.decide.accept import (
    equivalents,
    least_share,
    needed,
    refuse,
    scores,
    tied_at_last,
    too_small,
)
from calibration.decide.heldout import HeldOut
from calibration.decide.scan import Contender, fit_with
from calibration.decide.selection import Selection
from calibration.decide.thresholds import BY_HELD_OUT_ROWS
from calibration.finding import UNKNOWN
from tests.calibration.decide.made import PERIOD_S, line, problem, term
from tests.calibration.decide.test_accept import GOOD, contender, scored

ROWS, NOISE = 2400, 0.3
A, B, C, LUCK = np.random.default_rng(31).standard_normal((4, ROWS))


def one(name: str, x: np.ndarray, **more: Any) -> Candidate:
    return term(name, x.reshape(ROWS, -1), **more)


def beside(s: Selection, c: Candidate) -> Contender:
    found = fit_with(s.problem, s.columns, c)
    assert found is not None
    return found


def of(y: np.ndarray, *some: Candidate, **more: Any) -> Selection:
    s = Selection.of(replace(problem(y + NOISE * LUCK), **more))
    return s.keep([beside(s, c) for c in some])


def test_scores_are_of_what_the_contender_adds_to_the_others() -> None:
    s = of(2 * A + B, one("brake_drag", A))
    for found in scores(s, beside(s, one("play", B))):
        assert found.before == pytest.approx(np.hypot(1.0, NOISE), rel=0.1)
        assert found.after == pytest.approx(NOISE, rel=0.1)


@pytest.mark.parametrize("named", [True, False])
def test_a_function_without_a_name_must_take_an_eighth(named: bool) -> None:
    who = contender()
    who.candidate.name = "play" if named else UNKNOWN
    assert (refuse(who, scored(0.11), scored(0.0), 0.05, 1) == "") is named
    assert refuse(who, scored(0.13), scored(0.0), 0.05, 1) == ""
    assert refuse(who, scored(0.13), scored(0.0), 0.15, 1).startswith(
        "cross-validated mean square falls by 13.0"
    )


@pytest.mark.parametrize(
    ("share", "z", "held", "name", "accepted"),
    [
        (0.03, 4.5, 0.3, "play", True),
        (0.01, 4.5, 0.3, "play", False),
        (0.03, 3.5, 0.3, "play", False),
        (0.03, 4.5, 0.2, "play", False),
        (0.03, 4.5, 0.3, UNKNOWN, False),
    ],
)
def test_a_steady_name_may_be_in_the_noises_filter(
    share: float, z: float, held: float, name: str, accepted: bool
) -> None:
    who = contender()
    who.candidate.name = name
    assert (refuse(who, scored(share, z), scored(held), 0.05, 1) == "") is accepted


def test_every_fold_must_gain_a_twentieth_to_stand_for_luck() -> None:
    low = scored(0.04, 1.0, everywhere=True)
    assert "within luck (z = 1.0)" in refuse(contender(), low, GOOD, 0.02, 1)
    assert refuse(contender(), replace(low, share=0.06), GOOD, 0.02, 1) == ""
    assert refuse(contender(), GOOD, HeldOut(), 0.02, 1) == "no held-out rows to test it on"


@pytest.mark.parametrize(("kind", "stage", "tried", "least"), [
    ("line", None, 1, 7.0), ("line", None, 10_000, 8.0), ("line", "worm", 1, 4.0), ("linear", None, 1, 4.0),
])  # fmt: skip
def test_a_line_of_no_stage_is_the_best_of_a_spectrum(
    kind: str, stage: str | None, tried: int, least: float
) -> None:
    for more, accepted in ((0.01, True), (-0.01, False)):
        who = contender(evidence=least + more, after=lambda k: 0.0)
        who.candidate.kind, who.candidate.stage = kind, stage
        assert (refuse(who, GOOD, GOOD, 0.05, tried) == "") is accepted
        who.candidate.least = 9.0  # a form that needs more to be believed
        assert "too little evidence" in refuse(who, GOOD, GOOD, 0.05, tried)


def test_held_out_rows_are_no_evidence_by_luck_or_for_what_has_no_name() -> None:
    who = contender(evidence=4.0 + BY_HELD_OUT_ROWS + 0.1, after=lambda k: 0.0)
    apart = replace(scored(0.6), apart=True)
    assert refuse(who, GOOD, apart, 0.05, 1) == ""
    assert refuse(who, GOOD, replace(apart, z=1.9), 0.05, 1) != ""
    who.candidate.name = UNKNOWN
    assert refuse(who, GOOD, apart, 0.05, 1) != ""


@pytest.mark.parametrize(("per_log", "share", "z", "times"), [
    (2.1, 0.6, 9.0, 2), (1.1, 0.6, 9.0, 4), (0.9, 0.6, 9.0, 0), (2.1, 0.04, 9.0, 0), (2.1, 0.6, 1.9, 0),
])  # fmt: skip
def test_up_to_four_times_the_log_would_decide(per_log: float, share: float, z: float, times: int) -> None:
    who = contender(evidence=3.5, after=lambda k: per_log * k)
    why = refuse(who, GOOD, scored(share, z), 0.05, 1)
    assert why == (
        f"the log is too short for it: it lowers the held-out mean square by {100 * share:.0f} %, but"
        f" -log10 p is 3.5 of 4.0. A log {times} times as long would decide." if times
        else "too little evidence (-log10 p = 3.5)"
    )  # fmt: skip


def test_evidence_for_the_best_of_none_is_that_for_one() -> None:
    assert needed(0) == needed(1) == 4.0


@pytest.mark.parametrize("seconds", [14, 60, 600])
def test_the_share_a_line_needs_has_its_evidence_and_a_hundredth_less_has_not(seconds: int) -> None:
    """F(2, blocks - 1) has p = (1 + 2 x / m)^(-m / 2) at x, with m = blocks - 1 (closed form for two)."""
    p = problem(np.zeros(round(seconds / PERIOD_S)))
    rows = 15 * seconds  # of three runs of four, 20 in a second and in a block
    m = rows / 20 - 1

    def evidence(share: float) -> float:
        return m / 2 * np.log10(1 + rows * share / (1 - share) / m)

    share = least_share(p, 1000)
    assert evidence(share) >= 7.0 > evidence(share - 0.01)
    assert least_share(problem(np.zeros(40)), 1000) == 1.0  # two blocks tell nothing


def test_what_takes_less_than_the_columns_steps_is_too_small() -> None:
    s = of(0.5 * A, step=0.6)
    why = too_small(s, beside(s, one("play", A)))
    assert why.endswith(" N m rms away, less than its columns are sure to (0.6)")
    assert float(why.split()[1]) == pytest.approx(0.5, abs=0.03)
    s.problem.step = 0.4
    assert too_small(s, beside(s, one("play", A))) == ""


def own(x: np.ndarray, *others: np.ndarray) -> np.ndarray:
    """What is `x`'s own beside others and a constant, on fitted rows, of a mean square of one."""
    train, m = problem(x).train, np.column_stack([np.ones(ROWS), *others])
    x = x - m @ np.linalg.lstsq(m[train], x[train], rcond=None)[0]
    return np.asarray(x / np.std(x[train]))


@pytest.mark.parametrize(("part", "small"), [(2.94, True), (3.06, False)])
def test_a_further_effect_takes_more_than_the_models_error(part: float, small: bool) -> None:
    """Of an amplitude of two, beside as much that neither takes, 3 % is the error."""
    a, b, c = own(A), own(B, A), own(C, A, B)
    s = Selection.of(replace(problem(2 * a + 0.02 * part * b + 2 * c), ar_order=0))
    s = s.keep([beside(s, one("brake_drag", a))])
    why = too_small(s, beside(s, one("play", b)))
    assert why == ("takes 2.9 % of what the others take, which is within their own error" if small else "")
    assert too_small(s, beside(s, one("play", b)), further=False) == ""


@pytest.mark.parametrize(("off", "ties"), [(0.02, True), (0.04, False)])
def test_a_rival_may_lose_two_standard_errors(off: float, ties: bool) -> None:
    """Off by e, of noise s in n rows: n e^2 / 2 s^2 is lost, e sqrt(n) / s its error. 4 of 2.8, 16 of 5.7."""
    s = Selection.of(replace(problem(A + NOISE * own(LUCK, A, B)), ar_order=0))
    fitted = np.where(s.problem.held, 0.0, off * B)  # held-out rows say nothing
    found = equivalents(s, [beside(s, one("rival", A + fitted))], beside(s, one("best", A)))
    assert (found != []) == ties


@pytest.mark.parametrize(
    ("name", "x", "ties"),
    [
        ("twin", A + 1e-3 * B, True),
        ("other", B, False),
        ("half", A + 0.5 * B, False),
        ("best", A + 1e-3 * B, False),  # of the same name and place
        (UNKNOWN, A + 1e-3 * B, True),
        ("wider", np.column_stack([A, B]), False),
    ],
)
def test_what_ties_has_another_name_and_no_more_columns(name: str, x: np.ndarray, ties: bool) -> None:
    s = of(A)
    best, rival = beside(s, one("best", A)), beside(s, one(name, x))
    assert [c.candidate.name for c in equivalents(s, [rival], best)] == ([name] if ties else [])
    nobody = beside(s, one(UNKNOWN, A, stage="a"))
    assert (equivalents(s, [rival], nobody) != []) == (name == "best" or (ties and name != UNKNOWN))


def test_held_out_rows_part_what_fitted_rows_do_not() -> None:
    held = problem(A).held
    s = of(A)
    best, rival = beside(s, one("best", A)), beside(s, one("twin", np.where(held, 0.3 * A, A)))
    assert equivalents(s, [rival], best) == []
    assert equivalents(s, [best], rival) == [best]  # the better one there is no worse a name


def test_ties_are_asked_again_beside_all_that_was_chosen() -> None:
    """What ties beside the others stays, the same name elsewhere as it was, and no other does."""
    s = of(A + C, one("drag", A), one("brake", C))
    other = replace(one("drag", A), fixed={"motor": (2.0, "1")})
    twin, far = one("twin", A + 1e-3 * B), one("far", A + B)
    bare = Selection.of(s.problem)

    def tied(*some: Candidate) -> list[str]:
        pick = replace(s.chosen[0], confounded=[beside(bare, c) for c in some])
        return [c.candidate.name for c in tied_at_last(s.put(0, pick), 0)]

    assert tied() == [] and tied(other) == ["drag"]
    assert tied(other, twin, far) == ["drag", "twin"]
    assert tied(far) == []


def test_a_pick_that_cannot_be_determined_any_more_keeps_its_class() -> None:
    s = of(A, one("drag", A))
    refused = replace(s.chosen[0].candidate, sign=-1)
    pick = replace(
        s.chosen[0], candidate=refused, confounded=[beside(Selection.of(s.problem), one("far", B))]
    )
    assert [c.candidate.name for c in tied_at_last(s.put(0, pick), 0)] == ["far"]


def test_a_line_is_worth_its_place() -> None:
    turns = np.linspace(0, 40, ROWS)
    pair = line("gear_mesh", turns, 3.0)
    s = of(pair.columns[:, 0])
    best = beside(s, pair)
    assert [
        c.candidate.name for c in equivalents(s, [beside(s, replace(pair, name="bearing_pass"))], best)
    ] == ["bearing_pass"]
    assert equivalents(s, [beside(s, line("bearing_pass", turns, 3.2))], best) == []
