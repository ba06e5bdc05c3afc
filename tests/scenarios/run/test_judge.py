"""Verdicts on programmes, faults and expectations of runs made by hand, where the answer needs no program."""

import dataclasses
import itertools
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from host.logs.traces import Trace
from host.procedures.autoguide import Guided
from host.procedures.pointing_run import Visit
from host.sky.catalogue import star
from host.sky.observed import observe_many
from host.sky.pointstars import Sighting
from plant.parts import MountErrors, Number
from scenarios.lab.layers import Evidence
from scenarios.language.document import parse
from scenarios.language.load import convert
from scenarios.language.model import Expectation
from scenarios.language.programme import Record
from scenarios.run import errors, evaluate
from scenarios.run.outcome import Outcome

SCENARIO = convert(
    parse(
        """\
name: by hand
start_utc: 2026-02-10T14:00:00Z
time_limit: 50 s
steps:
  - {name: first, wait: {for: 1 s}}
  - {name: second, wait: {for: 1 s}}
  - {name: third, wait: {for: 1 s}}
""",
        Path("hand.yaml"),
    )
)
INDEX_ARCSEC = {"hour_angle": 50.0, "declination": 100.0}
Made = Callable[..., Outcome]


def programme(*ends: str, **more: Any) -> evaluate.Verdict:
    """The first verdict on steps that ended well, with a word of what failed, or not at all (-)."""
    records = [
        Record(step, 0.0, None if end == "-" else 1.0, failed="" if end in ("ok", "-") else end)
        for step, end in zip(SCENARIO.steps, ends, strict=False)
    ]
    return evaluate.judge(Outcome(Path(), SCENARIO, records, more))[0]


@pytest.mark.parametrize(
    ("ends", "interrupted", "passed", "value", "reason"),
    [
        (("ok", "ok", "ok"), False, True, 3, ""),
        (("ok", "jammed", "-"), False, False, 1, "second: jammed"),
        (("ok", "jammed", "-"), True, False, 1, "second: jammed"),
        (("ok", "ok", "ok"), True, True, 3, ""),
        (("jammed", "late", "ok"), False, False, 1, "first: jammed"),
        (("ok", "-", "-"), False, False, 1, "still going at the time limit of 50 s"),
        (("ok", "-", "-"), True, False, 1, "the run was interrupted"),
        (("-", "-", "-"), False, False, 0, "still going at the time limit of 50 s"),
    ],
)
def test_a_programme_is_its_steps_and_the_first_reason_counts(
    ends: tuple[str, ...], interrupted: bool, passed: bool, value: int, reason: str
) -> None:
    verdict = programme(*ends, interrupted=interrupted)
    assert (verdict.passed, verdict.value, verdict.limit) == (passed, value, 3)
    assert (verdict.name, verdict.unit, verdict.upper) == ("programme completed", "steps", False)
    assert verdict.reason == reason


def test_a_run_that_was_cut_off_passes_nothing_though_its_steps_are_done() -> None:
    records = [Record(step, 0.0, 1.0) for step in SCENARIO.steps]
    whole, cut_off = (
        evaluate.judge(Outcome(Path(), SCENARIO, records, {"interrupted": each})) for each in (False, True)
    )
    assert [(each.name, each.passed) for each in whole] == [("programme completed", True)]
    assert [(each.name, each.passed, each.limit, each.reason) for each in cut_off[1:]] == [
        ("run to its end", False, 1, "the run was interrupted")
    ]


def test_a_line_of_the_summary_has_a_reason_only_where_there_is_one() -> None:
    good, bad = programme("ok", "ok", "ok").as_json(), programme("ok", "-", "-").as_json()
    told = {"name": "programme completed", "passed": True, "value": 3, "limit": 3, "unit": "steps"}
    assert good == told
    assert bad == told | {"passed": False, "value": 1, "reason": "still going at the time limit of 50 s"}


def test_a_fault_that_met_nothing_fails_the_run_before_the_expectations() -> None:
    silent = Evidence("stuck", at_ns=2_500_000_000, may_not_act=False, where="line 7")
    acted, allowed = dataclasses.replace(silent, first_ns=3), dataclasses.replace(silent, may_not_act=True)
    few = Expectation(name="few", kind="overruns", arguments={}, limit=3.0, upper=True, where="")
    scenario = dataclasses.replace(SCENARIO, expectations=(few,))
    outcome = Outcome(Path(), scenario, [], {"overruns": 2}, faults=[acted, silent, allowed])
    names = [verdict.name for verdict in evaluate.judge(outcome)]
    assert names == ["programme completed", "fault stuck from 2.5 s on acted", "few"]
    fault = evaluate.judge(outcome)[1]
    assert (fault.passed, fault.value, fault.limit, fault.upper) == (False, 0, 1, False)
    assert fault.reason == "line 7: it met nothing; may_not_act: true beside it allows that"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Made:
    """An outcome of two guided steps and two moves of the focus, with expectations on it."""
    folder = tmp_path_factory.mktemp("made")
    t = np.arange(0.0, 40.0, 0.1)
    trace = Trace(folder / "focus.parquet", ("t_s", "true_half_steps"), {})
    trace.append(np.stack([t, np.where(t < 20.0, 103.0, -44.0)], axis=1))
    trace.close()
    steps = [dataclasses.replace(SCENARIO.steps[0], name=name, action=action) for name, action in (
        ("guide", "autoguide"), ("hold", "focus"), ("in", "focus"), ("out", "focus"), ("again", "autoguide"),
    )]  # fmt: skip
    offs = [(9.0, 9.0), (3.0, -4.0), (-1.0, 2.0), (9.0, 9.0)]
    seen = tuple(
        Guided(t_s=t_s, off=off, sent=(0.0, 0.0), pulses_s=(0.0, 0.0))
        for t_s, off in zip((1.0, 5.0, 10.0, 99.0), offs, strict=True)
    )
    far = (Guided(t_s=31.0, off=(0.0, 20.0), sent=(0.0, 0.0), pulses_s=(0.0, 0.0)),)
    records = [
        Record(steps[0], 2.0, 10.0, guided=seen),
        Record(steps[1], 0.0, 40.0),  # no move: a focus step without a goal
        Record(steps[2], 0.0, 19.9, focus_goal=100.0),
        Record(steps[3], 20.0, 39.9, focus_goal=-40.0),
        Record(steps[4], 30.0, 40.0, guided=far),
    ]
    return lambda: Outcome(folder, SCENARIO, list(records), {})


@pytest.mark.parametrize(("given", "value"), [
    ({"during": "guide"}, 5.0),  # 3, 4, 5
    ({"during": "guide", "axis": "ra"}, 3.0),
    ({"during": "guide", "axis": "dec"}, 4.0),
    ({"during": "guide", "axis": "dec", "statistic": "final"}, 2.0),
    ({"during": "guide", "axis": "dec", "statistic": "mean"}, 1.0),
    ({"during": "guide", "settle": 3.0}, 5.0),  # the window begins with an exposure
    ({"during": "guide", "settle": 5.0}, math.sqrt(5.0)),
    ({}, 20.0),  # both steps
])  # fmt: skip
def test_guiding_is_judged_by_the_exposures_within_the_window(
    made: Made, given: dict[str, Any], value: float
) -> None:
    assert evaluate.guiding_error(made(), given) == pytest.approx(value)


@pytest.mark.parametrize(("given", "value"), [
    ({"during": "in"}, 3.0), ({"during": "out"}, 4.0), ({}, 4.0), ({"statistic": "mean"}, 0.5),
])  # fmt: skip
def test_focus_is_judged_against_where_each_step_sent_it(
    made: Made, given: dict[str, Any], value: float
) -> None:
    assert evaluate.focus_error(made(), given) == pytest.approx(value, abs=0.01)


def test_a_step_without_a_move_or_a_row_has_no_focus_error(made: Made) -> None:
    with pytest.raises(errors.NoData, match="no focus move"):
        evaluate.focus_error(made(), {"during": "hold"})
    late = made()
    late.records[2] = Record(late.records[2].step, 100.0, 110.0, focus_goal=100.0)
    with pytest.raises(errors.NoData, match="no focus move"):
        evaluate.focus_error(late, {"during": "in"})
    with pytest.raises(errors.NoData, match="nothing was recorded"):
        evaluate.guiding_error(made(), {"during": "again", "settle": 5.0})


@pytest.mark.parametrize("upper", [True, False])
def test_an_expectation_without_data_fails_says_why_and_keeps_its_unit(made: Made, upper: bool) -> None:
    wanted = Expectation(
        name="near", kind="focus_error", arguments={"during": "hold"}, limit=2.0, upper=upper, where=""
    )
    outcome = dataclasses.replace(made(), scenario=dataclasses.replace(SCENARIO, expectations=(wanted,)))
    verdict = evaluate.judge(outcome)[-1]
    assert (verdict.passed, verdict.value, verdict.upper) == (False, None, upper)
    assert (verdict.reason, verdict.unit) == ("no focus move in the window", "half steps")


@pytest.mark.parametrize(("settle_s", "window"), [
    (0.0, (2.0, 10.0)), (3.0, (5.0, 10.0)), (8.0, None), (9.0, None),
])  # fmt: skip
def test_a_window_is_what_settling_leaves(
    made: Made, settle_s: float, window: tuple[float, float] | None
) -> None:
    outcome = made()
    assert outcome.window(outcome.record("guide"), settle_s) == window
    assert outcome.window(Record(SCENARIO.steps[0], 2.0)) is None


def test_a_pointing_run_looks_at_each_star_until_the_tick_before_it_leaves() -> None:
    sighting = Sighting(hour_angle_rad=0.0, declination_rad=0.0, ra_steps=0, dec_steps=0)
    visits = tuple(
        Visit(t_s=t_s, star=star(name), sighting=sighting)
        for t_s, name in ((10.0, "Pollux"), (30.0, "Capella"))
    )
    record = Record(SCENARIO.steps[0], 0.0, 40.0, visits=visits)
    found = errors.looks(record, 0.0, 40.0)
    assert [each[0].name for each in found] == ["Pollux", "Capella"]
    assert [each[1:] for each in found] == [pytest.approx((9.75, 9.95)), pytest.approx((29.75, 29.95))]
    tracked = dataclasses.replace(record, star=star("Pollux"))
    assert errors.looks(tracked, 1.0, 2.0) == [(star("Pollux"), 1.0, 2.0)]
    with pytest.raises(errors.NoData, match="'first' has no target"):
        errors.looks(dataclasses.replace(record, visits=()), 0.0, 40.0)


def test_pieces_of_a_long_window_share_no_moment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(errors, "PIECE_S", 10.0)
    pieces = errors._pieces(0.0, 25.0)
    assert len(pieces) == 3 and pieces[0][0] == 0.0 and pieces[-1][1] == 25.0
    for (_, end), (begin, _) in itertools.pairwise(pieces):
        assert end < begin and begin - end < 1e-9


@pytest.fixture(scope="module")
def aside(tmp_path_factory: pytest.TempPathFactory) -> Outcome:
    """A telescope 6″ east and 4″ south of Pollux, a turn of the axis on; its encoders say 1″ and 2″.

    It turns at 21.5″/s in declination, which is what no star asks for.
    """
    folder, pollux = tmp_path_factory.mktemp("aside"), star("Pollux")
    t = np.arange(0.0, 20.0, 0.1)
    place = observe_many(pollux, SCENARIO.site, SCENARIO.clock, t)
    offs = {"ra": -2.0 * math.pi - math.radians(6.0 / 3600), "dec": -math.radians(4.0 / 3600)}
    for (name, off), angle in zip(offs.items(), place, strict=False):
        trace = Trace(folder / f"truth-{name}.parquet", ("t_s", "angle", "rate"), {})
        trace.append(np.stack([t, angle + off + math.pi, np.full_like(t, math.radians(21.5 / 3600))], axis=1))
        trace.close()
    host = Trace(
        folder / "host.parquet", ("t_s", "ra_error_arcsec", "dec_error_arcsec", "focus_half_steps"), {}
    )
    ra = np.where(t < 1.0, np.nan, 1.0)
    host.append(np.stack([t, ra, np.full_like(t, 2.0), np.zeros_like(t)], axis=1))
    host.close()
    turning = {"axis": "dec", "rate": 20.0}
    steps = {
        "track": SCENARIO.steps[0],
        "set_rate": dataclasses.replace(SCENARIO.steps[1], arguments=turning),
        "wait": SCENARIO.steps[2],
    }
    records = [
        Record(dataclasses.replace(step, name=name, action=name), 0.0, 20.0) for name, step in steps.items()
    ]
    records[0] = dataclasses.replace(records[0], star=pollux)
    return Outcome(folder, SCENARIO, records, {})


@pytest.mark.parametrize(("given", "value"), [
    ({"axis": "ra"}, 6.0), ({"axis": "dec"}, 4.0),
    ({"axis": "sky"}, math.hypot(6.0 * math.cos(math.radians(28.03)), 4.0)),
    ({"axis": "ra", "source": "encoder"}, 1.0), ({"axis": "dec", "source": "encoder"}, 2.0),
    ({"during": "track", "axis": "dec", "statistic": "rms"}, 4.0),
])  # fmt: skip
def test_pointing_is_judged_by_axis_and_source(aside: Outcome, given: dict[str, Any], value: float) -> None:
    assert evaluate.pointing_error(aside, given) == pytest.approx(value, abs=0.002)


def test_pointing_is_of_the_sky_and_not_of_the_axes(aside: Outcome) -> None:
    """An index error is what the axes read less where the telescope looks (Wallace)."""
    zeros = {each.name: Number(0.0, "arcsec", "by hand") for each in dataclasses.fields(MountErrors)}
    index = {f"{name}_index": Number(value, "arcsec", "by hand") for name, value in INDEX_ARCSEC.items()}
    outcome = dataclasses.replace(aside, errors=MountErrors(**zeros | index))
    assert evaluate.pointing_error(outcome, {"axis": "ra"}) == pytest.approx(6.0 + 50.0, abs=0.002)
    assert evaluate.pointing_error(outcome, {"axis": "dec"}) == pytest.approx(4.0 + 100.0, abs=0.002)


def test_a_rate_is_judged_against_the_star_or_the_rate_that_was_set(aside: Outcome) -> None:
    of_dec = {"axis": "dec", "during": "set_rate"}
    assert evaluate.tracking_rate_error(aside, of_dec) == pytest.approx(1.5, abs=1e-6)
    # a star's declination stands but for refraction, less than 0.1″/s there: all of the rate is an error
    of_star = {"axis": "dec", "during": "track"}
    assert evaluate.tracking_rate_error(aside, of_star) == pytest.approx(21.5, abs=0.1)
    with pytest.raises(errors.NoData, match="moves the other axis"):
        evaluate.tracking_rate_error(aside, of_dec | {"axis": "ra"})
    with pytest.raises(errors.NoData, match="neither a target nor a rate"):
        evaluate.tracking_rate_error(aside, {"during": "wait"})
