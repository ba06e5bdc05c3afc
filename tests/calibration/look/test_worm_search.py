"""The search of periods: slower ones become drift, a part gets its best harmonics, idle ones are refused."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.balances.mounts import Part
from calibration.finding import UNKNOWN
from calibration.look import worm
from calibration.look.worm import Mount
from tests.calibration.look.test_worm_parts import mount, problem

look: Any = worm


def period(rate: float | None, stage: str | None = None, key: str = "") -> Any:
    return Some(frequency=rate, stage=stage, key=key or f"{stage} {rate}", say=lambda: f"{key or stage}")


def found(name: str, *rates: float | None, after: float = 1.0) -> Any:
    chosen = [Some(candidate=period(rate)) for rate in rates]
    return Some(name=name, chosen=chosen, refused=[name], held=Some(after=after))


def searched(monkeypatch: pytest.MonkeyPatch, m: Mount, *results: Any) -> Any:
    """What is taken of searches in turn, and their problems with the parts that were looked for."""
    asked: Any = []
    each = iter(results)

    def search(p: Any, m: Any, seen: list[Part], span: float) -> Any:
        assert span == 5000.0
        asked.append((p, [part.name for part in seen]))
        return next(each)

    monkeypatch.setattr(look, "_search", search)
    monkeypatch.setattr(look, "longest_span", lambda p: 5000.0)
    monkeypatch.setattr(look, "is_seen", lambda p, rate: rate != 0.5)
    return look.worms("all", lambda slowest_s: f"{slowest_s:.0f}", m), asked


def test_what_is_slower_than_the_slowest_found_becomes_drift(monkeypatch: pytest.MonkeyPatch) -> None:
    m = mount(1 / 1000, 1 / 100, 1 / 50, 0.5)  # the last one is not seen
    s, asked = searched(monkeypatch, m, found("one", 1 / 100, 1 / 50), found("two", 1 / 50), found("none"))
    names = [f"part {k}" for k in range(3)]
    assert asked == [("all", names), ("100", names[1:]), ("50", names[2:])]
    assert s.name == "two" and s.refused == ["one", "two"]


@pytest.mark.parametrize(("found_s", "searches"), [(890.0, 2), (910.0, 1), (2000.0, 1)])
def test_a_period_near_the_slowest_one_ends_the_search(
    monkeypatch: pytest.MonkeyPatch, found_s: float, searches: int
) -> None:
    _, asked = searched(monkeypatch, mount(1 / 1000), found("one", 1 / found_s, 1 / 10), found("none"))
    assert len(asked) == searches
    assert len(searched(monkeypatch, mount(1 / 1000), found("none"))[1]) == 1


def test_a_period_that_is_just_next_ends_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(look, "NEXT", 0.5)
    assert len(searched(monkeypatch, mount(1 / 2048), found("one", 1 / 1024), found("none"))[1]) == 1


def test_a_choice_without_a_period_is_one_of_a_second(monkeypatch: pytest.MonkeyPatch) -> None:
    _, asked = searched(monkeypatch, mount(0.01), found("one", None), found("none"))
    assert asked[1][0] == "1"


@pytest.mark.parametrize(("after", "better"), [(0.9, True), (1.0, True), (1.1, False)])
def test_a_part_that_is_chosen_gets_its_best_number_of_harmonics(
    monkeypatch: pytest.MonkeyPatch, after: float, better: bool
) -> None:
    asked: Any = []
    worms = [period(0.01, "part 0", f"worm {n}") for n in (1, 2, 5, 8)]
    free, best = period(0.02, None, "free"), period(0.01, "part 0", "best")
    first = found("first")
    first.chosen = [Some(candidate=worms[1]), Some(candidate=free)]
    second = Some(name="second", chosen=[], held=Some(after=after))
    results = iter([first, second])

    def settle(p: Any, candidates: Any, named: bool) -> Any:
        asked.append(([c.key for c in candidates], named))
        return next(results)

    def part_candidates(p: Any, m: Any, part: Part, counts: Any) -> Any:
        assert counts == (1, 2, 5, 8)
        return worms

    monkeypatch.setattr(look, "part_candidates", part_candidates)
    monkeypatch.setattr(look, "free_periods", lambda p, m, span: [free])
    monkeypatch.setattr(look, "settle", settle)
    monkeypatch.setattr(look, "best_count", lambda p, s, m, part: [best])
    m = mount(0.01, 0.03)
    s = look._search(None, m, m.parts[:1], 900.0)
    assert asked == [([*[w.key for w in worms], "free"], True), (["free", "best"], True)]
    assert s.name == ("second" if better else "first")


def test_the_best_number_of_harmonics_predicts_best(monkeypatch: pytest.MonkeyPatch) -> None:
    p = problem(900.0)
    some = [Some(columns=np.full((len(p.t), 1), float(k))) for k in range(3)]
    counts: Any = []
    monkeypatch.setattr(look, "part_candidates", lambda p, m, part, of: counts.extend(of) or some)
    monkeypatch.setattr(
        look, "cross_validate", lambda p, base, x, w: Some(after=[2.0, 1.0, 3.0][int(x[0, 1])])
    )
    s = Some(after=Some(whitener=None))
    assert look.best_count(p, s, None, None) == [some[1]] and counts == list(range(1, 9))
    monkeypatch.setattr(look, "part_candidates", lambda *_: [])
    assert look.best_count(p, s, None, None) == []


@pytest.mark.parametrize(("second", "leads"), [((0.0, 4.0), False), ((0.0, 6.5), True)])
def test_a_harmonic_leads_by_the_mean_of_all_sections(
    monkeypatch: pytest.MonkeyPatch, second: tuple[float, float], leads: bool
) -> None:
    """Turns of 5 and 1, harmonics of 1 and 4 or 6.5."""
    rates: Any = []
    monkeypatch.setattr(look, "sections_of", lambda p, rate: rates.append(rate) or 2)
    sizes = np.array([3.0, 4.0, 0.0, 1.0, 1.0, 0.0, *second])
    s = Some(problem=None, candidates=[period(0.01)], sizes=lambda k: sizes)
    assert look._harmonic_leads(s, 0) == leads and rates == [0.01]


TRUE = 0.02


def moving(rate: float, stage: str | None = None, sure: bool = True) -> Any:
    """A choice next to a wave of 0.02 Hz over 900 s, beside an offset."""
    p = problem(900.0)
    p.y = 5.0 + np.sin(2 * np.pi * TRUE * p.t + 1.0)
    c = Candidate(UNKNOWN, "time", worm.harmonics(p, rate, (1,)), (), frequency=rate, stage=stage)
    return Some(problem=p, candidates=[c], without=lambda k: Some(columns=p.base), after=Some(whitener=None))


@pytest.mark.parametrize(
    ("off", "stage", "sure", "moves"),
    [
        (0.2, None, False, True),
        (-0.5, None, False, True),
        (0.0, None, True, False),
        (0.2, "worm", True, True),
        (0.2, "worm", False, False),  # of a part another must predict clearly better
        (0.0, "worm", True, False),
        (0.05, "worm", True, True),  # 2.8 thousandths of the rate
    ],
)
def test_a_period_that_fits_better_is_taken(
    monkeypatch: pytest.MonkeyPatch, off: float, stage: str | None, sure: bool, moves: bool
) -> None:
    """By parts of a turn in the section."""
    monkeypatch.setattr(look, "cross_validate", lambda p, x0, x1, w: Some(sure=sure))
    other = look._elsewhere(moving(TRUE - off / 900.0, stage), 0)
    assert len(other) == moves
    if moves:
        assert other[0].frequency == pytest.approx(TRUE) and other[0].name == UNKNOWN
        assert other[0].domain == "time" and other[0].columns.shape[1] == 2


def test_a_part_keeps_its_rate_to_two_thousandths(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(look, "cross_validate", lambda p, x0, x1, w: Some(sure=True))
    monkeypatch.setattr(look, "NEAR", np.array([0.0, 0.03]))  # 1.7 thousandths
    assert look._elsewhere(moving(TRUE - 0.03 / 900.0, "worm"), 0) == []
    assert len(look._elsewhere(moving(TRUE - 0.03 / 900.0), 0)) == 1


def settled(
    monkeypatch: pytest.MonkeyPatch, *some: Any, named: bool = True, share: float = 0.9, z: float = 9.0,
    leads: bool = False, moved: Any = (), only: str = "",
) -> Any:  # fmt: skip
    """Every candidate is chosen, and judged by the same numbers, or only one is; looks, and their most."""
    asked: Any = []
    monkeypatch.setattr(look, "longest_span", lambda p: 1000.0)

    def select(p: Any, candidates: Any, most: int, before: int) -> Any:
        asked.append(([c.key for c in candidates], most, before))
        chosen = [Some(candidate=c) for c in candidates if not only or c.key == only]
        return Some(chosen=chosen, refused=["later"], after=Some(whitener=None), model=None,
                    without=lambda k: Some(model=None))  # fmt: skip

    given = iter([list(moved)])
    monkeypatch.setattr(look, "select", select)
    monkeypatch.setattr(look, "compare", lambda *_: Some(share=share, z=z))
    monkeypatch.setattr(look, "_harmonic_leads", lambda s, k: leads)
    monkeypatch.setattr(look, "_elsewhere", lambda s, k: next(given, []))
    return look.settle(None, list(some), named), asked


PART, FREE = period(0.01, "worm", "worm"), period(0.05, None, "free")
OFF = "% off the held-out mean square"


@pytest.mark.parametrize(
    ("c", "given", "why"),
    [
        (PART, {"share": 0.151}, ""),
        (PART, {"share": 0.15}, f"takes 15 {OFF}; a part of this mount must take 15 %"),
        (PART, {"share": -0.5}, f"takes 0 {OFF}; a part of this mount must take 15 %"),
        (PART, {"share": 0.3, "named": False}, f"takes 30 {OFF}; a period that was tried must take 35 %"),
        (PART, {"share": 0.36, "named": False}, ""),
        (FREE, {"share": 0.35}, f"takes 35 {OFF}; a period that was tried must take 35 %"),
        (FREE, {"share": 0.36}, ""),
        (PART, {"z": 2.0}, ""),
        (PART, {"z": 1.94}, f"takes 90 {OFF}, within luck (z = 1.9)"),
        (PART, {"leads": True}, ""),
        (FREE, {"leads": True, "named": False}, ""),
        (PART, {"leads": True, "named": False},
         "a harmonic is larger than the turn itself, on a wheel that is only assumed"),
    ],
)  # fmt: skip
def test_what_takes_too_little_is_left_out_and_said(
    monkeypatch: pytest.MonkeyPatch, c: Any, given: dict[str, Any], why: str
) -> None:
    s, asked = settled(monkeypatch, c, **given)
    if not why:
        assert s.refused == ["later"] and asked == [([c.key], 2, 0)]
        return
    assert [(r.what, r.why) for r in s.refused[:-1]] == [(c.key, why)] and s.refused[-1] == "later"
    assert asked == [([c.key], 2, 0), ([], 2, 1)]  # one was tried before


def test_a_better_period_takes_the_place_of_those_within_a_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    near = [period(rate, None, f"{rate}") for rate in (0.0505, 0.052, 0.0491, 0.048)]
    other = period(0.0509, None, "better")
    s, asked = settled(monkeypatch, PART, *near, moved=[other], only="0.0505")
    assert asked[0] == (["worm", "0.0505", "0.052", "0.0491", "0.048"], 2, 0)
    assert asked[1] == (["worm", "0.052", "0.0491", "0.048", "better"], 2, 0)
    assert s.refused == ["later"]
    s, asked = settled(monkeypatch, PART, *near, moved=[other], only="worm")
    assert asked[1][0] == ["0.052", "0.0491", "0.048", "better"]
    assert [r.why for r in s.refused[:-1]] == ["a period of 19.6 s predicts better"]
    exact, beside = period(8 / 1000, None, "edge"), period(9 / 1000, None, "b")
    _, asked = settled(monkeypatch, exact, beside, moved=[period(7 / 1000, None, "new")], only="b")
    assert asked[1][0] == ["edge", "b", "new"]
