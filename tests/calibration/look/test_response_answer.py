"""The answer of a drive with a rig file put together: its filters, rows, needs, gaps and what is held out."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.errors import CalibrationInputError
from calibration.finding import UNKNOWN, Finding
from calibration.inputs.run import Run
from calibration.look import response
from calibration.look.looked import Options
from tests.calibration.look.test_steps_and_events import noise, problem

look: Any = response
NAMED = Finding("worm", "K", "axis_angle", share=0.5)
NAMELESS = Finding(UNKNOWN, "K", "time", share=0.9)


def run(rows: int = 200, name: str = "one", step_s: float = 0.1) -> Run:
    t = np.arange(0.0, rows) * step_s
    return Run(name, Path(name), name, {"t": t}, period_s=step_s)


def rig(**more: Any) -> Any:
    given = {"smooth_s": None, "analyse_period_s": None, "path": Path("rig.yaml"), "name": "a rig"}
    return Some(**{**given, **more})


@pytest.mark.parametrize(
    ("runs", "given", "why"),
    [
        ([run(199)], {}, "199 rows are too few to say anything (at least 200)"),
        ([run(100), run(100)], {}, ""),
        ([run(201)], {"smooth_s": 0.4}, ""),  # a fiftieth of 20 s
        ([run(201)], {"smooth_s": 0.41}, "smooth_s: 0.41 s is too long for a run of 20 s"),
        ([run(201)], {"analyse_period_s": 0.5}, "analyse_period_s: 0.5 s is too long for a run of 20 s"),
        ([run(401), run(201)], {"smooth_s": 0.5}, "smooth_s: 0.5 s is too long for a run of 20 s"),
    ],
)
def test_records_are_long_enough_together_and_each_for_its_filter(
    runs: list[Run], given: dict[str, float], why: str
) -> None:
    if why:
        with pytest.raises(CalibrationInputError, match=why.replace("(", r"\(").replace(")", r"\)")):
            look._check(runs, rig(**given))
    else:
        look._check(runs, rig(**given))


def agreement(**more: Any) -> Any:
    given: dict[str, Any] = {
        "channel": "velocity", "unit": "m/s", "delay_s": 0.02, "error_s": 0.001, "before": 5.0, "after": 3.0,
        "floor": 1.0, "late": True, "left": 1.0, "hardly": False, "scaled": "",
    }  # fmt: skip
    return Some(**{**given, **more})


@pytest.mark.parametrize(
    ("more", "after", "floor"),
    [
        ({}, 3.0, 1.0),
        ({"late": False, "left": 2.1}, 5.0, 1.0),
        ({"late": False, "left": 2.0}, None, None),
        ({"before": np.inf}, None, None),
        ({"floor": np.nan}, 3.0, None),
    ],
)
def test_a_velocity_has_a_row_where_it_says_something(
    more: dict[str, Any], after: float | None, floor: float | None
) -> None:
    row = {"velocity": {"unit": "m/s", "before": 5.0, "after": after, "floor": floor}}
    assert look._velocity(agreement(**more)) == ({} if after is None else row)
    assert look._velocity(None) == {}


def test_what_is_held_out_is_named_by_file_run_and_time() -> None:
    """Two files of 300 rows, the second of two runs; every third of a second is a row."""
    session, labels = np.repeat([0, 1], 300), np.repeat([0, 1, 2], [300, 150, 150])
    held = np.zeros(600, dtype=bool)
    held[200:300] = held[300:450] = held[500:520] = True
    p = replace(problem(noise(rows=600), labels), session=session, held=held)
    view = Some(t=np.arange(600) / 4 - np.repeat([0.0, 60.0], 300), rows=np.arange(600))
    names = list(look._held_names(view, p, [run(name="a"), run(name="b")]))
    assert names == ["a run 1 from 50 s", "b", "b run 3 from 65 s to 69.75 s"]
    turned = replace(p, turned=np.ones(600, dtype=bool))
    assert list(look._held_names(view, turned, [1, 2, 3])) == ["each of 3 files in its turn"]


def test_gaps_are_counted_and_added_up() -> None:
    files = [Some(name="a", gaps=list), Some(name="b", gaps=lambda: [(1.0, 3.5)]),
             Some(name="c", gaps=lambda: [(1.0, 2.0), (7.0, 9.0)])]  # fmt: skip
    assert list(look._gaps(files)) == ["b: 1 gap, 2.5 s without rows", "c: 2 gaps, 3 s without rows"]


def balance(*findings: Finding, after: float = 1.0, missing: Any = "m", **more: Any) -> Any:
    given = {"notes": ["note"], "short": [], "needs": [], "missing": missing, "findings": list(findings),
             "error": {"before": 2.0, "after": after}, **more}  # fmt: skip
    return Some(**given)


CLOCK = replace(NAMED, channel="S", domain="clock", share=0.0)


@pytest.mark.parametrize(
    ("first", "wide", "second", "narrow"),
    [
        (balance(after=2.0), 5.0, balance(NAMED), True),
        (balance(after=2.0), 4.0, balance(NAMED), False),  # no narrower
        (balance(after=2.0), 5.0, balance(NAMELESS), False),
        (balance(after=2.0), 5.0, balance(CLOCK), False),
        (balance(after=1.9), 5.0, balance(NAMED), False),  # it explains something
        (balance(after=2.0, missing=None), 5.0, balance(NAMED), False),
    ],
)
def test_a_narrower_filter_is_taken_where_it_alone_shows_a_name(
    monkeypatch: pytest.MonkeyPatch, first: Any, wide: float, second: Any, narrow: bool
) -> None:
    """Five deviations of five rows of 10 ms: the usual filter is a quarter of a second wide."""
    view = Some(rig="rig", response=Some(channel="force"), wide=wide, period_s=0.01)
    finer = Some(wide=4.0)
    each = iter([first, second])
    said: Any = []
    monkeypatch.setattr(look, "look_at_forces", lambda *_: next(each))
    monkeypatch.setattr(look, "view_of", lambda records, rig, response, limits: finer)
    monkeypatch.setattr(look, "replace", lambda b, notes: Some(**{**vars(b), "notes": notes}))
    got, b = look._through_its_filter(view, [], Options(tell=said.append))
    assert (got is finer) == narrow
    note = "force: behind the usual filter of 0.25 s nothing shows; a narrower one is taken"
    assert b.notes == ([note, "note"] if narrow else ["note"])
    assert bool(said) == (first.missing is not None and first.error["after"] == 2.0 and wide > 4.0)


def answer(
    monkeypatch: pytest.MonkeyPatch, *balances: Any, dynamic: Any = (False, True), law: Any = None,
    electric: Any = None, velocity: Any = None, volts: bool = False, records: Any = None,
) -> tuple[Any, Any]:  # fmt: skip
    """Of a rig with a response per balance: the answer, and what the others were asked."""
    files = [run()] if records is None else records
    asked: dict[str, Any] = {"said": []}
    each, ways = iter(balances), iter(dynamic)

    def view_of(records: Any, rig: Any, response: Any) -> Any:
        return Some(response=response, dynamic=next(ways), name=response.channel)

    def through(view: Any, *_: Any) -> Any:
        b = next(each)
        b.selection = Some(problem=Some(once=f"once of {view.name}"))
        return view, b

    def at(what: str, result: Any) -> Any:
        return lambda view, p: asked.update({what: (view.name, p)}) or result

    def repairs(records: Any, channels: Any) -> Any:
        asked["repaired"] = channels
        return []

    for name, made in (
        ("align_counters", lambda *_: asked["said"].append("aligned")),
        ("view_of", view_of), ("_through_its_filter", through),
        ("problem_of", lambda *_: Some(held="held")), ("look_at_law", at("law", law)),
        ("velocity_against_position", lambda view, held: asked["said"].append(view.name) or velocity),
        ("_held_names", lambda view, p, records: [view.name]), ("look_at_volts", at("volts", electric)),
        ("has_volts", lambda view: volts), ("repairs_found", repairs),
        ("unnamed_where_missing", lambda effects, needs, b: (effects, [*needs, f"of {len(b)} balances"])),
    ):  # fmt: skip
        monkeypatch.setattr(look, name, made)
    one = rig(responses=[Some(channel=f"r{k}") for k in range(len(balances))])
    return look.look_at_response(
        Some(records=files, clock="stamps"), one, Options(tell=asked["said"].append)
    ), asked


def test_responses_law_and_volts_are_looked_at_in_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    told, asked = answer(monkeypatch, balance(NAMELESS), balance(NAMED))
    assert asked["said"] == [
        "aligned", "r0: columns",
        "r0", "r1: columns", "command: the controller's law", "voltage: winding and back-EMF",
    ]  # fmt: skip
    assert asked["law"] == asked["volts"] == ("r1", "once of r1")  # of the first that accelerates
    assert told.title == "a rig" and told.effects == [NAMED, NAMELESS] and told.held_out == ["r0"]
    assert told.needs == ["of 2 balances"] and told.notes == [] == told.remarks and told.rows == {}
    assert answer(monkeypatch, balance(), balance(), dynamic=(False, False))[1]["law"][0] == "r0"
    assert asked["repaired"] == ()


def test_effects_are_told_the_named_ones_first_and_columns_last(monkeypatch: pytest.MonkeyPatch) -> None:
    rival = replace(NAMELESS, equivalent=["worm"], share=0.2)
    less = replace(NAMED, share=0.1)
    told, _ = answer(monkeypatch, balance(CLOCK, NAMELESS, less, rival, NAMED), dynamic=(True,))
    assert told.effects == [NAMED, rival, less, NAMELESS, CLOCK]


@pytest.mark.parametrize(("hz", "told"), [(9.79, True), (9.81, False), (10.19, False), (10.21, True)])
def test_a_line_of_the_command_that_is_a_balance_s_is_told_once(
    monkeypatch: pytest.MonkeyPatch, hz: float, told: bool
) -> None:
    """Of 10 Hz, within two hundredths."""
    line = replace(NAMED, name="bearing_pass", frequency=10.0)
    law = balance(replace(NAMED, name="disturbance", frequency=hz))
    effects = answer(monkeypatch, balance(line), law=law, dynamic=(True,))[0].effects
    assert (len(effects) == 2) == told
    plain = balance(replace(NAMED, name="gain"))
    slow = replace(NAMED, frequency=1.0)
    said, asked = answer(monkeypatch, balance(slow), law=plain, dynamic=(True,))
    assert len(said.effects) == 2 and asked["repaired"] == ("effort",) and len(said.balances) == 2


def test_volts_that_are_too_few_are_a_need(monkeypatch: pytest.MonkeyPatch) -> None:
    few, _ = answer(monkeypatch, balance(), volts=True, dynamic=(True,))
    assert few.remarks == [look.FEW_VOLTS]
    some, _ = answer(monkeypatch, balance(), volts=True, electric=balance(NAMED), dynamic=(True,))
    assert some.remarks == [] and some.effects == [NAMED] and len(some.balances) == 2


@pytest.mark.parametrize(
    ("left", "hardly", "late", "strange"),
    [
        (2.1, False, False, True),
        (2.0, False, False, False),
        (2.1, True, False, False),
        (2.1, False, True, True),
    ],
)
def test_a_velocity_that_is_not_the_position_s_rate_is_a_need(
    monkeypatch: pytest.MonkeyPatch, left: float, hardly: bool, late: bool, strange: bool
) -> None:
    a = agreement(left=left, hardly=hardly, late=late, scaled="half")
    needs = balance(short=["short"], needs=["a", "short", "b", "c", "d"])
    told, _ = answer(monkeypatch, needs, velocity=a, dynamic=(True,))
    said = f"velocity is not the position's rate ({left:.1f} floors apart): find out how it is made"
    every = ["short", *([said] if strange else []), "a", "b", "c"]
    assert told.needs == [*every[:4], "of 1 balances"]
    assert told.remarks == [*([said] if strange else []), "half"]
    assert (
        bool(told.rows) == (late or left > 2) and [f.name for f in told.effects] == ["channel_delay"] * late
    )
    if late:
        assert told.effects[0].share == 0.0 and "late against the position" in told.effects[0].note


def test_repairs_and_starts_are_notes(monkeypatch: pytest.MonkeyPatch) -> None:
    one, two = run(name="a"), run(name="b")
    one.repairs = [Some(kind="spike", channel="x", note="3 rows"), Some(kind="leap", channel="y", note="far")]  # type: ignore[list-item]
    told, _ = answer(monkeypatch, balance(), records=[one, two], dynamic=(True,))
    assert told.notes == ["the files' starts are taken from stamps", "a, x: 3 rows"]
    assert told.remarks == ["a, y: far"]


def test_records_that_are_too_short_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(CalibrationInputError, match="9 rows are too few"):
        answer(monkeypatch, balance(), records=[run(9)])
