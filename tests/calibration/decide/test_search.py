"""The steps of the search one by one: what is offered, what is taken at once, what is looked at again."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.decide import select as module
from calibration.decide.scan import Contender, fit_with
from calibration.decide.select import _apart, _explains_more, _polished, _Search, _shared, gate, select
from calibration.decide.selection import NO_SCORES, Selection
from calibration.decide.thresholds import FEWEST_BLOCKS, MARGIN, ROWS_PER_COLUMN
from tests.calibration.decide.made import PERIOD_S, line, problem, term

ROWS = 2400
T = PERIOD_S * np.arange(ROWS)
RNG = np.random.default_rng(91)
A, B, C, LUCK = RNG.standard_normal((4, ROWS))
DRAG, WRAP, PLAY = (
    term(name, x[:, None]) for name, x in zip(("drag", "wrap", "play"), (A, B, C), strict=True)
)
NEARLY = term("nearly", (A + 0.5 * C)[:, None])
FIRST, SECOND = line("first", T, 1.0), line("second", T, 2.3)
LINES = 3.0 * FIRST.columns[:, 0] + 1.5 * SECOND.columns[:, 0]


def chosen(y: np.ndarray, *some: Candidate, noise: float = 0.5) -> Selection:
    s = Selection.of(problem(y + noise * LUCK))
    return s.keep([x for c in some if (x := fit_with(s.problem, s.problem.base, c)) is not None])


def search(y: np.ndarray, candidates: list[Candidate], *some: Candidate, before: int = 0) -> _Search:
    return _Search(chosen(y, *some), candidates, MARGIN, before)


def names(found: list[Contender] | list[Candidate]) -> list[str]:
    return [x.name if isinstance(x, Candidate) else x.candidate.name for x in found]


def test_as_many_are_looked_at_as_were_offered_and_before() -> None:
    assert select(problem(LUCK), [DRAG, WRAP, PLAY]).looked_at == 3
    assert select(problem(LUCK), [DRAG, WRAP], before=5).looked_at == 7
    nothing = select(problem(LUCK), [])
    assert (nothing.looked_at, nothing.scores) == (0, NO_SCORES)


@pytest.mark.parametrize(("rows", "looked_at"), [(3, 1), (2, 1), (1, 2)])
def test_a_fit_needs_eight_rows_a_column_and_of_too_short_a_log_all_count(rows: int, looked_at: int) -> None:
    """Of a base of one column, one candidate has one column more and the other three."""
    wide = term("wide", np.column_stack([A, B, C]))
    p = problem(2 * A + 0.1 * LUCK)
    p.ar_order = 0
    p.valid = np.arange(ROWS) < {3: 4, 2: 2, 1: 1}[rows] * ROWS_PER_COLUMN - (rows == 3)
    s = select(p, [DRAG, wide])
    assert s.looked_at == looked_at


def test_a_log_of_few_blocks_offers_what_a_declared_stage_has() -> None:
    """They make the noise's filter, too; twenty blocks of one second are enough."""
    staged = replace(FIRST, stage="motor")
    for blocks, looked_at in ((FEWEST_BLOCKS, 2), (FEWEST_BLOCKS - 1, 1)):
        p = problem(LUCK)
        p.valid = np.arange(ROWS) < 20 * blocks
        s = select(p, [DRAG, staged])
        assert s.looked_at == looked_at
        told = [r.why for r in s.refused if r.what == "every effect that no declared stage has"]
        assert len(told) == (looked_at == 1) and all("20 independent blocks (20 s)" in why for why in told)
        assert select(p, []).refused == []


def test_lines_that_have_nothing_in_common_are_taken_at_once_others_one_by_one() -> None:
    s = search(LINES, [FIRST, SECOND])
    assert sorted(names(s.accepted(s.picks, [FIRST, SECOND], 4))) == ["first", "second"]
    assert len(s.accepted(s.picks, [FIRST, SECOND], 1)) == 1
    assert len(s.accepted(s.picks, [FIRST, SECOND], 4, further=False)) == 1
    two = search(2.0 * A + 1.5 * B, [DRAG, WRAP])
    assert names(two.accepted(two.picks, [DRAG, WRAP], 4)) == ["drag"]
    both = search(LINES + 0.4 * A, [FIRST, SECOND, DRAG])
    assert sorted(names(both.accepted(both.picks, [FIRST, SECOND, DRAG], 4))) == ["first", "second"]


def test_an_accepted_effect_has_its_gain_on_rows_that_were_held_out() -> None:
    s = search(2.0 * A, [DRAG])
    (found,) = s.accepted(s.picks, [DRAG], 4)
    assert found.held.share == pytest.approx(4.0 / 4.25, abs=0.05) and s.picks.refused == []


def test_a_refusal_is_told_until_something_is_accepted_and_not_where_a_pick_is_looked_at_again() -> None:
    y = 2.0 * np.where(problem(A).held, -A, A)  # of held-out rows the other way round
    s = search(y, [DRAG])
    assert s.accepted(s.picks, [DRAG], 4) == [] and [r.what for r in s.picks.refused] == ["drag"]
    again = search(y, [DRAG])
    assert again.accepted(again.picks, [DRAG], 4, further=False) == [] and again.picks.refused == []
    third = line("third", T, 3.7)
    turned = np.where(problem(A).held, -1.0, 1.0) * third.columns[:, 0]
    mixed = search(LINES + turned, [FIRST, SECOND, third])
    assert "third" not in names(mixed.accepted(mixed.picks, [FIRST, SECOND, third], 4))
    assert mixed.picks.refused == []


@pytest.mark.parametrize("most", [1, 2, 3])
def test_no_more_are_taken_than_asked_for_though_two_lines_come_at_once(most: int) -> None:
    third = line("third", T, 3.7)
    s = search(LINES + 1.2 * third.columns[:, 0], [FIRST, SECOND, third])
    s.pick(most)
    assert len(s.picks.chosen) == most and s.picks.refused == []


def test_two_lines_at_once_beside_a_first_are_cut_to_what_was_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    all_three = chosen(LINES + 2.0 * A, DRAG, FIRST, SECOND).chosen
    s, offered = search(LINES + 2.0 * A, [DRAG, FIRST, SECOND]), [all_three[:1], all_three[1:], []]
    monkeypatch.setattr(s, "accepted", lambda *given: offered.pop(0))
    s.pick(2)
    assert names(s.picks.candidates) == ["drag", "first"] and len(offered) == 1


def test_after_the_last_one_nothing_more_is_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    s, calls = search(2.0 * A, [DRAG, WRAP]), []
    accepted = s.accepted

    def counted(*given: Any, **more: Any) -> list[Contender]:
        calls.append(len(s.picks.chosen))
        return accepted(*given, **more)

    monkeypatch.setattr(s, "accepted", counted)
    s.pick(1)
    assert calls == [0]
    s = search(2.0 * A + 1.5 * B, [DRAG, WRAP])
    s.picks = s.picks.keep([])
    s.pick(5)
    assert names(s.picks.candidates) == ["drag", "wrap"]


def test_a_pick_that_imitates_is_replaced_by_what_explains_it_better() -> None:
    s = search(2.0 * A + 2.0 * B, [NEARLY, WRAP, DRAG], NEARLY, WRAP)
    assert s._look_again(0)
    assert names(s.picks.candidates) == ["drag", "wrap"]
    assert [(r.what, r.why) for r in s.picks.refused] == [("nearly", "drag explains it better")]


def test_a_pick_that_is_the_best_stays_as_does_one_that_nothing_can_replace() -> None:
    s = search(2.0 * A + 2.0 * B, [NEARLY, WRAP, DRAG], DRAG, WRAP)
    assert not s._look_again(0)
    assert names(s.picks.candidates) == ["drag", "wrap"] and s.picks.refused == []
    none = search(0.0 * A, [PLAY], PLAY)
    assert not none._look_again(0)
    assert names(none.picks.candidates) == ["play"] and none.picks.refused == []
    again = search(2.0 * A + 2.0 * B, [DRAG, WRAP], DRAG, WRAP)
    again.picks = again.picks.put(0, replace(again.picks.chosen[0], gain=-1.0))
    again._look_again(0)
    assert again.picks.chosen[0].gain > 0.0  # fitted anew beside the others


@pytest.mark.parametrize(("better", "looked"), [(False, [0]), (True, [0, 1, 2])])
def test_only_picks_with_something_in_common_are_looked_at_again_or_all_after_one_was_replaced(
    better: bool, looked: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    s, calls = search(2.0 * A + 2.0 * B + C, [], NEARLY, WRAP, DRAG), list[int]()

    def again(self: _Search, k: int) -> bool:
        calls.append(k)
        return better

    monkeypatch.setattr(_Search, "_look_again", again)
    s.revise()
    assert calls == looked
    calls.clear()
    apart = search(2.0 * A + 2.0 * B + C, [], DRAG, WRAP, PLAY)
    apart.revise()
    assert calls == []


def test_once_one_was_replaced_all_later_ones_are_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    """The second one is not replaced; the third is looked at nevertheless."""
    s, calls = search(2.0 * A + 2.0 * B + C, [], NEARLY, WRAP, DRAG), list[int]()

    def again(self: _Search, k: int) -> bool:
        calls.append(k)
        return k == 0

    monkeypatch.setattr(_Search, "_look_again", again)
    s.revise()
    assert calls == [0, 1, 2]


def test_what_the_search_took_is_revised() -> None:
    """Of two parts one has a sign that physics excludes: it goes at the end."""
    two = term("friction_asymmetry", np.column_stack([A, B]), positive=())
    s = search(2.0 * A - 0.5 * B, [], two)
    s.picks.chosen[0] = replace(s.picks.chosen[0], candidate=replace(two, sign=1))
    s.revise()
    assert [c.labels for c in s.picks.candidates] == [(("size_0", "N m"),)]


def test_search_revises(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[str] = []
    monkeypatch.setattr(_Search, "revise", lambda self: calls.append("revised"))
    select(problem(LUCK), [DRAG])
    assert calls == ["revised"]


@pytest.mark.parametrize("angle", [0.2, 1.0, 1.5])
@pytest.mark.parametrize("mean", [0.0, 5.0])
def test_two_share_the_square_of_their_angles_cosine_but_for_their_means(angle: float, mean: float) -> None:
    p = problem(A)
    q = np.linalg.qr(np.column_stack([np.ones(p.train.sum()), A[p.train], B[p.train]]))[0]
    x = np.zeros((ROWS, 2))
    x[p.train] = q[:, 1:] * 50.0
    one = term("one", x[:, :1] + mean)
    other = term("other", (np.cos(angle) * x[:, 0] + np.sin(angle) * x[:, 1])[:, None] - mean)
    assert _shared(p, one, other) == pytest.approx(np.cos(angle) ** 2)
    assert _shared(p, term("both", x), other) == pytest.approx(1.0)


def test_lines_are_apart_where_they_share_nothing_and_others_never_are() -> None:
    p = problem(A)
    taken = [x for c in (FIRST,) if (x := fit_with(p, p.base, c)) is not None]
    assert _apart(p, SECOND, taken)
    assert not _apart(p, line("near", T, 1.002), taken)
    assert not _apart(p, DRAG, taken)
    assert not _apart(p, SECOND, [*taken, *(x for x in [fit_with(p, p.base, DRAG)] if x is not None)])


@pytest.mark.parametrize(
    ("rest", "margin", "better"), [(0.6, 0.05, True), (0.2, 0.05, False), (0.2, 0.01, True)]
)
def test_another_choice_explains_more_by_more_than_the_margin(
    rest: float, margin: float, better: bool
) -> None:
    """What the one lacks of A is `rest` times B, in noise of one: a share of rest^2 / (1 + rest^2)."""
    y = 2.0 * A + rest * B
    other, one = chosen(y, DRAG, noise=1.0), chosen(y, DRAG, WRAP, noise=1.0)
    assert bool(_explains_more(one, other, margin)) is better
    assert not _explains_more(other, one, margin) and not _explains_more(chosen(y), other, margin)


def test_a_gain_that_one_fold_lacks_explains_no_more() -> None:
    """In every fifth piece of six seconds there is nothing of the column."""
    piece = np.arange(ROWS) % 600 // 120
    x = np.where((piece + np.arange(ROWS) // 600) % 5 == 2, 0.0, B)
    y = 2.0 * A + x
    assert not _explains_more(chosen(y, DRAG, WRAP), chosen(y, DRAG), 0.01)
    assert _explains_more(chosen(y, DRAG, term("true", x[:, None])), chosen(y, DRAG), 0.01)


def test_the_only_effect_stands_where_nothing_is_around_it() -> None:
    s = select(problem(2.0 * A + LUCK), [DRAG], around=True)
    assert names(s.candidates) == ["drag"]


def test_a_surrogates_score_is_a_probabilitys_logarithm() -> None:
    """Of one candidate on white noise -log10 p has the mean 1 / ln 10; a true one's is far above."""
    s = chosen(2.0 * A, DRAG)
    scores = gate(s, [DRAG], np.random.default_rng(1))
    assert len(scores.surrogate_max) == 400
    assert np.mean(scores.surrogate_max) == pytest.approx(1 / np.log(10), abs=0.09)
    assert scores.value[0] > 10 * scores.threshold
    both = gate(s, [DRAG, *(term(f"n{k}", RNG.standard_normal((ROWS, 20))) for k in range(4))], RNG)
    assert len(both.value) == 5 and both.value.argmax() == 0


def ramps(p: np.ndarray) -> np.ndarray:
    return np.asarray(np.clip((T - p[0]) / max(float(p[1]), 1.0), 0.0, 1.0))[:, None]


def ramp(start: float, duration: float, **more: Any) -> Candidate:
    at = {"start": (start, "s"), "duration": (duration, "s")}
    own = {"shape": ramps, "steps": (2.0, 4.0), "fixed": at, **more}
    return term("brake_drag", ramps(np.array([start, duration])), **own)


def test_an_onset_and_its_ramp_are_moved_together_beside_the_others() -> None:
    s = chosen(2.0 * ramps(np.array([30.0, 20.0]))[:, 0] + A, DRAG, ramp(34.0, 12.0), noise=0.05)
    moved = _polished(s, 1)
    assert names(moved.candidates) == ["drag", "brake_drag"]
    assert moved.candidates[1].point == pytest.approx([30.0, 20.0], abs=0.5)
    assert _polished(s, 0) is s
    one = chosen(2.0 * A, replace(ramp(34.0, 12.0), steps=(2.0,)))
    assert _polished(one, 0) is one


def test_a_move_that_physics_refuses_or_that_gains_nothing_is_not_made(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    s = chosen(2.0 * ramps(np.array([30.0, 20.0]))[:, 0], ramp(30.0, 20.0, sign=1))
    for moved in (replace(ramp(30.0, 20.0, sign=1), columns=-ramp(30.0, 20.0).columns), ramp(60.0, 20.0)):
        monkeypatch.setattr(module, "polish", lambda rest, c, moved=moved: moved)
        assert _polished(s, 0).candidates[0].point.tolist() == [30.0, 20.0]
        assert _polished(s, 0).sizes(0)[0] == pytest.approx(2.0, abs=0.1)
