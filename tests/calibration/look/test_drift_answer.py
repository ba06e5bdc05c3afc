"""The answer of a guide log put together: what is needed, what is refused, which turns are looked over."""

from dataclasses import replace
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.balances.mounts import SIDEREAL_DAY_S, Part
from calibration.decide.residual import Left
from calibration.decide.selection import Selection
from calibration.finding import Finding
from calibration.look import drift, looked, worm
from calibration.look.looked import Options
from calibration.look.worm import Mount
from tests.calibration.look.test_worm_parts import mount, problem

look: Any = drift
WORM, JUMP = Finding("gear_eccentricity", "K", "axis_angle"), Finding("unknown", "K", "time")


def answer(
    monkeypatch: pytest.MonkeyPatch, *, frames: int = 100, parts: int = 2, hold_out: Any = (),
    rig: Any = None, known: Any = (), seen: bool = True, clock: bool = False, refused: Any = (),
    missing: str = "", short: bool = False,
) -> Any:  # fmt: skip
    """Of a log of so many fitted frames, whose search is given; what was asked for is written down."""
    asked: dict[str, Any] = {}
    given = [Part(f"part {k}", 0.01 / (k + 1)) for k in range(parts)]
    run = Some(header={"mount": "EQ6"}, notes=["of the file"], among=lambda names: short or "x" in names)

    def guide_problem(sections: Any, names: Any, slowest_s: float, quickest_s: float) -> Any:
        asked.setdefault("made", []).append((round(slowest_s), round(quickest_s)))
        train = np.arange(200) < frames
        return Some(train=train, domains={"clock": 1} if clock else {}, name=round(slowest_s)), ["the end"]

    def worms(p: Any, drifting: Any, m: Mount) -> Any:
        asked["mount"], asked["slower"] = m, drifting(44.0).name
        return Some(problem=p, name="s")

    def balance(s: Any, m: Any, slow: Any, tried: Any) -> Any:
        asked["slow"], asked["tried"] = slow, tried
        return Some(missing=Some(where=missing) if missing else None, still="still", short=["too short"])

    def withdraw(found: Any, failed: Any) -> Any:
        assert failed == "of controls"
        return list(found), list(refused)

    for module, name, made in (
        (look, "usable", lambda runs, names: (runs, ["left out"])),
        (look, "parts", lambda sections, rig: given),
        (look, "known_mount", lambda sections: known),
        (look, "guide_problem", guide_problem),
        (look, "worms", worms),
        (look, "longest_span", lambda p: 1000.0),
        (look, "with_jumps", lambda s, when: (Some(problem=s.problem, name="jumped"), [JUMP])),
        (look, "piece_s", lambda p: 33.4),
        (look, "is_seen", lambda p, rate: seen or rate > 0.0099),
        (look, "controls", lambda s, wrong, reversed_time: [s.name, reversed_time]),
        (look, "findings", lambda s, m, span: [WORM] if span == 1000.0 else []),
        (look, "merge", lambda found: found),
        (look, "failed_controls", lambda tried: "of controls"),
        (look, "withdraw", withdraw),
        (look, "_balance", balance),
        (looked, "unnamed_where_missing", lambda effects, needs, _: (effects, needs)),
    ):
        monkeypatch.setattr(module, name, made)
    told = look.look_at_drift([run], rig, Options(hold_out=list(hold_out)))
    return told, asked


def test_a_log_of_frames_in_turn_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    told, asked = answer(monkeypatch)
    assert told.title == "Guide log, EQ6" and told.effects == [WORM, JUMP] and told.needs == ["too short"]
    assert told.held_out == ["pieces of 33 s, in turn"]
    assert told.notes == ["of the file", "left out", look.OF_ALL_FRAMES]
    assert asked["made"] == [(200, 100), (44, 100)] and asked["slower"] == 44  # slowest, quickest
    assert asked["slow"] == [] and asked["tried"] == ["jumped", False] and not asked["mount"].named


def test_a_part_that_is_held_out_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    told, asked = answer(monkeypatch, hold_out=["end"], clock=True, rig="rig")
    assert told.effects == [WORM] and told.held_out == ["the end"] and asked["mount"].named
    assert told.notes == ["of the file", "left out", look.ON_THE_CLOCK] and asked["tried"] == ["s", False]
    assert answer(monkeypatch, known=(180,))[1]["mount"].named


@pytest.mark.parametrize(("rig", "need"), [
    (None, look.NEED), ("rig", "log two turns of the slowest part, 400 s, without a gap"),
])  # fmt: skip
def test_a_log_that_is_too_short_says_what_it_needs(
    monkeypatch: pytest.MonkeyPatch, rig: Any, need: str
) -> None:
    few, _ = answer(monkeypatch, frames=99, rig=rig)
    assert few.needs == [need] and few.notes == [
        "99 frames to fit are too few to say anything (at least 100)"
    ]
    none, _ = answer(monkeypatch, short=True)
    assert none.notes == ["no section is long enough to say anything"] and none.needs == [look.NEED]


def test_parts_that_are_too_slow_need_a_longer_section(monkeypatch: pytest.MonkeyPatch) -> None:
    few = "fewer than 2 turns in one section, and too few in all"
    told, asked = answer(monkeypatch, seen=False)
    assert asked["slow"] == [f"part 1 ({few})"]
    need = f"a longer section without a slew: two turns, for part 1 ({few})"
    assert told.needs == [need, "too short"]
    assert answer(monkeypatch, seen=False, parts=6)[1]["slow"] == [f"5 of the usual worms ({few})"]
    assert len(answer(monkeypatch, seen=False, parts=5)[1]["slow"]) == 4
    assert len(answer(monkeypatch, seen=False, parts=6, rig="rig")[1]["slow"]) == 5


def test_what_is_refused_or_missing_over_a_turn_is_a_need(monkeypatch: pytest.MonkeyPatch) -> None:
    close = [("K", "worm", "its control fits as well")]
    told, _ = answer(monkeypatch, refused=close, missing="over the turn of part 0")
    assert told.refused == close
    close_by = "worm was close, but its control fits as well"
    assert told.needs == [close_by, "still", "too short"]
    assert answer(monkeypatch, missing="over time alone")[0].needs == ["too short"]


def balance(monkeypatch: pytest.MonkeyPatch, m: Mount, missing: Any = None, clock: bool = True) -> Any:
    asked: Any = []
    monkeypatch.setattr(looked, "calibrated", lambda s, skip: {"skipped": skip})
    monkeypatch.setattr(looked, "missing_over", lambda b, places: asked.append(places) or missing)
    s = Selection.of(problem(900.0, clock=clock))
    return look._balance(s, m, ["slow"], [{"tried": 1}]), asked[0], s.problem


def test_what_is_left_is_looked_for_over_time_and_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    b, places, p = balance(monkeypatch, mount(0.01, 0.003))
    assert [x.domain for x in places] == [None] * 3 and places[0].x is p.t
    assert [x.words for x in places] == ["time", "the turn of part 0", "the turn of part 1"]
    x = (p.t + 7) * 0.003  # the clock is 7 s ahead
    assert places[2].x == pytest.approx(x - np.floor(x))
    assert (b.key, b.row, b.numbers) == ("position", "position", {"skipped": ("offset",)})
    assert (b.not_identifiable, b.controls) == (["slow"], [{"tried": 1}])
    assert b.spectrum.periods and b.spectrum.stages == {"part 0": 0.01, "part 1": 0.003}
    assert len(balance(monkeypatch, mount(*[0.01] * 4))[1]) == 5
    assert len(balance(monkeypatch, mount(*[0.01] * 5))[1]) == 1
    assert balance(monkeypatch, mount(0.01), clock=False)[1][1].x[1] == pytest.approx(0.03)


@pytest.mark.parametrize(
    ("domain", "share", "effect"), [(None, 0.41, True), (None, 0.4, False), ("time", 0.41, False)]
)
def test_most_over_a_turn_is_no_air(
    monkeypatch: pytest.MonkeyPatch, domain: str | None, share: float, effect: bool
) -> None:
    left = Left(3.0, 0.5, domain, "over it", share, effect=not effect)
    assert balance(monkeypatch, mount(0.01), left)[0].missing == replace(left, effect=effect)


def test_wrong_worms_of_two_sections_have_as_many_harmonics() -> None:
    p = problem(15_000.0, 15_000.0)
    columns = worm.harmonics(p, 0.002, (1, 2))
    c = Candidate("gear_eccentricity", "axis_angle", columns, (), frequency=0.002, stage="worm")
    p.t[p.run == 1] += 15_000.0
    rates = {"one tooth more": 0.002 + 1 / SIDEREAL_DAY_S, "one tooth less": 0.002 - 1 / SIDEREAL_DAY_S}
    for wrong, rate in zip(drift.wrong_worm(p, 0, c), rates.values(), strict=False):
        assert wrong.columns is not None and np.array_equal(wrong.columns, worm.harmonics(p, rate, (1, 2)))


def test_a_log_of_three_tenths_of_a_day_tells_a_tooth() -> None:
    p = problem(30_000.0)
    p.t = np.linspace(0.0, 0.3 * SIDEREAL_DAY_S, len(p.t))
    c = Candidate(
        "gear_eccentricity", "axis_angle", np.ones((len(p.t), 2)), (), frequency=0.002, stage="worm"
    )
    assert drift.wrong_worm(p, 0, c)[0].columns is not None
    p.t = p.t * 0.999
    assert drift.wrong_worm(p, 0, c)[0].columns is None
