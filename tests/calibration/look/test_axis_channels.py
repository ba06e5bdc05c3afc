"""Channels of an axis in turn, what they hand on, and a fault of a column that is undone or refused."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.decide.selection import Refusal
from calibration.finding import Finding, Parameter
from calibration.look import applied, axis_channels, axis_result
from calibration.look.looked import Options
from calibration.names.command_disturbance import NAME as DISTURBANCE
from plant.units import ARCSEC
from tests.calibration.names.made import drive

GAP = Finding("play", "K", "reversal")
LATE = Finding("channel_delay", "S", "clock")
NOTHING: Any = None
channels: Any = axis_channels


def held(after: float, before: float = 1.0) -> Any:
    return Some(held=Some(after=after, before=before), chosen=["c"])


def looks(monkeypatch: pytest.MonkeyPatch, *results: Any, refused: Any = None, judged: Any = None) -> Any:
    """Looks in turn, over logs that are told; what they leave before is half of T and none of E."""
    logs: Any = []
    each = iter(results)
    monkeypatch.setattr(channels, "_look", lambda runs, *_: logs.append(runs) or next(each))
    monkeypatch.setattr(channels, "merge", lambda x: list(x))
    monkeypatch.setattr(channels, "repair_stuck_bit", lambda run: None)
    monkeypatch.setattr(
        channels, "repair_wraps", lambda run: Finding(run, "S", "clock") if run != "a" else None
    )
    monkeypatch.setattr(applied, "too_little", lambda *_: refused)
    monkeypatch.setattr(applied, "corrected_runs", lambda result, f: [f"less {f.name}"])
    monkeypatch.setattr(applied, "before_of", lambda *_: {"T": 0.5, "E": 0.0})
    monkeypatch.setattr(applied, "judged", lambda *_: judged)
    monkeypatch.setattr(applied, "keep_untouched", lambda was, again: logs.append("kept"))
    return logs


def result(*findings: Finding, **fields: Any) -> Any:
    return Some(**{"findings": list(findings), "refused": [], "selections": {}, "before": {}, **fields})


def test_logs_without_a_fault_are_looked_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    other = Finding("worm", "K", "axis_angle")
    logs = looks(monkeypatch, result(other))
    found = channels.analyse(["a", "wrap b", "wrap c"], NOTHING, Options())
    assert [f.name for f in found.findings] == ["wrap b", "worm"] and logs == [["a", "wrap b", "wrap c"]]


@pytest.mark.parametrize("place", ["refused", "judged"])
def test_a_fault_that_is_refused_is_said(monkeypatch: pytest.MonkeyPatch, place: str) -> None:
    first = result(GAP, LATE)
    why = Refusal("play", "leaves most")
    logs = looks(monkeypatch, first, result(GAP), **{place: why})
    found = channels.analyse(["a"], NOTHING, Options())
    assert found is first and [f.name for f in found.findings] == ["channel_delay"]
    assert found.refused == [("K", "play", "leaves most")]
    assert logs == ([["a"]] if place == "refused" else [["a"], ["less play"]])


@pytest.mark.parametrize("fault", [GAP, LATE])
def test_a_fault_is_undone_and_all_is_looked_at_again(
    monkeypatch: pytest.MonkeyPatch, fault: Finding
) -> None:
    """Its share is what the corrected logs take off the error before, 2; clocks are the first look's."""
    stamp, worm = Finding("lost", "S", "clock"), Finding("worm", "K", "axis_angle")
    k = held(0.5, 3.0)
    first = result(stamp, fault, worm, selections={"K": k})
    other = Finding("brake", "T", "time")
    selections = {"T": held(0.25), "E": held(1.0), "K": held(9.0)}
    again = result(fault, Finding("lost", "S", "clock", share=0.5), other, selections=selections)
    said: Any = []
    logs = looks(monkeypatch, first, again)
    found = channels.analyse(["a"], NOTHING, Options(tell=said.append))
    assert found is again and logs == [["a"], [f"less {fault.name}"], "kept"]
    assert said == [f"once more without the {'play' if fault is GAP else 'channel delay'}"]
    assert [f.name for f in found.findings] == [fault.name, "lost", "brake"]
    assert found.findings[1] is stamp
    if fault is GAP:  # and the motors have seen the crossings
        assert found.selections["K"] is k and found.before == {"T": 0.5, "E": 0.0, "K": 3.0}
        assert found.findings[0].share == pytest.approx(1 - (0.5 / 3) ** 2)
    else:
        assert found.selections["K"].held.after == 9.0 and found.before == {"T": 0.5, "E": 0.0}
        assert found.findings[0].share == pytest.approx(0.75)


def look(
    monkeypatch: pytest.MonkeyPatch, selections: dict[str, Any], **fields: Any
) -> tuple[Any, Any, list[Any]]:
    """One look over stubbed channels: its result, what floors were asked for, what was told."""
    stamp = Finding("lost", "S", "clock")
    motion = Some(x=np.array([0.0, np.pi, 2 * np.pi]), rows=np.array([1, 2]))
    frame = Some(scale={"gear_ratio": 10.0})
    said: Any = []
    asked: dict[str, Any] = {}

    def channel(name: str, given: Any = None) -> Any:
        return lambda *_: said.append(name) or given

    monkeypatch.setattr(channels, "build_frame", lambda runs, rig: frame)
    monkeypatch.setattr(channels, "choose_held_out", lambda frame, names: (np.zeros(3, dtype=bool), ["end"]))
    one, none = Some(stamps=lambda _: stamp), Some(stamps=lambda _: None)
    monkeypatch.setattr(channels, "NAMES", {"a": one, "b": none, "c": Some(stamps=None)})
    monkeypatch.setattr(channels, "motion_of", lambda frame, width: motion)
    monkeypatch.setattr(channels, "declared_numbers", lambda *_: Some())

    def made(numbers: Any, frame: Any, m: Any, held: Any, findings: Any, held_out: Any) -> Any:
        given = {"electrical": None, "calibrated": {}, **fields}
        return Some(held=held, findings=findings if fields.get("with_stamps", True) else [],
                    held_out=held_out, selections=selections, **given)  # fmt: skip

    monkeypatch.setattr(channels, "AxisResult", made)
    monkeypatch.setattr(channels, "electrical_channel", channel("E", (40.0, {})))
    monkeypatch.setattr(channels, "encoder_channels", channel("K"))
    monkeypatch.setattr(channels, "full_rate", channel("S1"))
    monkeypatch.setattr(channels, "command_channel", channel("U"))
    monkeypatch.setattr(channels, "transmission", channel("drive", "drive"))
    monkeypatch.setattr(channels, "torque_channel", channel("T"))

    def floors(m: Any, drive: Any, held: Any, inertia: float, resistance: float) -> Any:
        asked["floors"] = (drive, inertia, resistance)
        return {"T": 0.1}

    monkeypatch.setattr(channels, "floors_of_pair", floors)
    monkeypatch.setattr(channels, "delay_findings", lambda *_: fields.get("late", []))

    def strange(residual: Any, p: Any, turns: Any) -> Any:
        asked["turns"] = turns.tolist()
        return fields.get("strange")

    monkeypatch.setattr(channels, "unexplained_volts", strange)
    return channels._look([], NOTHING, Options(tell=said.append)), asked, said


def test_channels_are_looked_at_in_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    found, asked, said = look(monkeypatch, {}, late=[LATE])
    assert [f.name for f in found.findings] == ["lost", "channel_delay"] and found.held_out == ["end"]
    assert said == [
        "electrical channel",
        "E",
        "encoder channels",
        "K",
        "S1",
        "U",
        "torque channel",
        "drive",
        "T",
    ]
    assert asked == {"floors": ("drive", 0.0, 0.0)} and found.floors == {"T": 0.1}
    numbers = {"calibrated": {"inertia": Parameter(3.0, "kg m2")}}
    _, asked, _ = look(monkeypatch, {}, electrical=Some(windings=Some(resistance=2.5)), **numbers)
    assert asked == {"floors": ("drive", 3.0, 2.5)}


def test_volts_that_nothing_explains_are_a_finding_where_there_is_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    e = {"E": Some(after=Some(residual=None), problem=None)}
    unknown = Finding("unknown", "E", "time")
    found, asked, _ = look(monkeypatch, e, with_stamps=False, strange=unknown)
    assert found.findings == [unknown] and asked["turns"] == [5.0, 10.0, 5.0, 10.0]  # of the motors
    found, _, _ = look(monkeypatch, e, with_stamps=False)
    assert found.findings == []
    found, asked, _ = look(monkeypatch, e, strange=unknown)
    assert [f.name for f in found.findings] == ["lost"] and "turns" not in asked


@pytest.mark.parametrize(
    ("compliance", "lag", "stiffness", "softness"),
    [
        (None, 0.0, 1000.0, 0.3),  # the declared stiffness, the smaller rotor
        (2e-3, -0.7 / ARCSEC, 500.0, 0.7),
        (2e-3, -0.1 / ARCSEC, 500.0, 0.6),  # no less than the smaller rotor has: 300 / 500
        (2e-3, -9.0 / ARCSEC, 500.0, 1.0),  # no more than the larger: 500 / 500
        (1e-8, -0.4 / ARCSEC, 1000.0, 0.4),  # too stiff to be told
    ],
)
def test_a_train_s_stiffness_and_lag_are_those_that_encoders_show(
    compliance: float | None, lag: float, stiffness: float, softness: float
) -> None:
    """Rotors of 3 and 5 kg m2 behind a ratio of 10: 300 and 500 at the axis."""
    beta = np.array([0.0, lag, compliance or 0.0])
    s = Some(after=Some(beta=beta), problem=Some(place=["", "rotor_lag", "compliance"].index))
    frame = Some(rig=Some(motors=Some(rotor_inertia=(3.0, 5.0))), scale={"gear_ratio": 10.0})
    given = result(frame=frame, declared=Some(stiffness=1000.0))
    given.selections = {} if compliance is None else {"K": s}
    drive = channels.transmission(given, 40.0, {})
    assert (drive.per_ampere, drive.stiffness) == (40.0, pytest.approx(stiffness))
    assert drive.softness_s2 == pytest.approx(softness)


def collected(**fields: Any) -> Any:
    """A result that writes down what it collects."""
    found = result(frame=Some(), motion=Some(rows=np.arange(3), x=None), held=None, rng=None, kinematic=None,
                   declared=Some(lines={}), scale_error=0.1, calibrated={"inertia": 1}, **fields)  # fmt: skip
    found.got = []
    found.collect = found.got.append
    return found


def test_encoders_are_compared_motor_by_motor_and_with_the_roller(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(channels, "kinematic_problem", lambda *_: Some(problem="K"))
    monkeypatch.setattr(channels, "roller_problem", lambda *_: "S")
    pairs: dict[str, Any] = {}
    monkeypatch.setattr(
        channels, "_candidates", lambda r, key, pair, p: pairs.update({key: pair.motor}) or [p]
    )
    monkeypatch.setattr(channels, "_within_the_plant", lambda p, some, rng: f"selected {p} of {some}")
    monkeypatch.setattr(channels, "train_stiffness", lambda s, e: ({"stiffness": s}, {"stiffness": e}))
    changed = Finding("stiffness_change", "K", "time")
    monkeypatch.setattr(
        channels, "changes", lambda fitted, spans, d, seen: [changed] if seen == {"moved"} else []
    )
    found = collected()
    channels.encoder_channels(found, 40.0)
    assert found.got == ["selected K of ['K']", "selected S of ['S']"]
    assert list(found.selections.items()) == list(zip("KS", found.got, strict=True))
    assert pairs["K"].tolist() == [0, 0, 0, 1, 1, 1] and pairs["S"] is None
    assert found.findings == [changed] and found.calibrated == {"inertia": 1, "stiffness": 0.1}
    monkeypatch.setattr(channels, "kinematic_problem", lambda *_: None)
    monkeypatch.setattr(channels, "roller_problem", lambda *_: None)
    empty = collected()
    channels.encoder_channels(empty, 40.0)
    assert empty.got == [] == empty.findings and empty.selections == {} and empty.kinematic is None


def test_what_is_larger_than_the_plant_lets_it_be_is_not_selected(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(channels, "select", lambda p, some, rng: Some(candidates=list(some)))
    monkeypatch.setattr(channels, "_beyond_the_plant", lambda s, k: s.candidates[k].key == "wild")
    some: Any = [Some(key="wild"), Some(key="tame")]
    assert [c.key for c in channels._within_the_plant(NOTHING, some, NOTHING).candidates] == ["tame"]


@pytest.mark.parametrize(("low", "beyond"), [(240.0, False), (240.1, True)])
def test_a_size_is_beyond_the_plant_from_four_of_its_bounds_on(
    monkeypatch: pytest.MonkeyPatch, low: float, beyond: bool
) -> None:
    """An eccentricity has 60 arcsec at most."""
    told = {"amplitude": Parameter(420.0, "arcsec", low, 483.0)}
    monkeypatch.setattr(channels, "parameters_of", lambda s, k: told)
    assert channels._beyond_the_plant(Some(candidates=[Some(name="encoder_eccentricity")]), 0) == beyond


@pytest.mark.parametrize(
    ("problem", "candidates", "chosen", "kept"),
    [
        ("p", ["c"], ["c"], True),
        ("p", ["c"], [], False),
        ("p", [], ["c"], False),
        (None, ["c"], ["c"], False),
    ],
)
def test_the_full_rate_is_a_channel_where_it_shows_something(
    monkeypatch: pytest.MonkeyPatch, problem: Any, candidates: list[str], chosen: list[str], kept: bool
) -> None:
    widths: Any = []
    s = Some(chosen=chosen)
    monkeypatch.setattr(channels, "motion_of", lambda frame, width: widths.append(width) or Some(width=width))
    monkeypatch.setattr(channels, "roller_problem", lambda *_: problem)
    monkeypatch.setattr(channels, "_candidates", lambda *_: candidates)
    monkeypatch.setattr(channels, "select", lambda p, some, rng, margin: s if margin == 0.002 else None)
    lines = [Finding("unknown", "E", "time"), Finding("second", "E", "time")]
    monkeypatch.setattr(channels, "pick_ups", lambda m: list(lines))
    found = collected()
    channels.full_rate(found)
    assert widths == [1] and found.got == ([s] if kept else [])
    assert found.selections == ({"S1": s} if kept else {}) and found.findings == lines[:1]
    driven = collected()
    driven.findings = [Finding(DISTURBANCE.name, "U", "time")]
    channels.full_rate(driven)
    assert len(driven.findings) == 1


def test_pick_up_is_looked_for_on_currents_that_flow(monkeypatch: pytest.MonkeyPatch) -> None:
    """More than 50 mA, in sound rows, of readings that are none that were filled."""
    m: Any = drive(np.arange(8.0)).view
    m.ok[0] = False
    current = np.array([1.0, 1.0, 1.0, 0.05, 0.051, 0.0, 1.0, -1.0])
    trusted = np.array([True, False, True, True, True, True, True, True])
    m.frame = Some(
        get=lambda name: current, filled=lambda name: (current, trusted), scale={"adc_A_per_count": 0.2}
    )
    seen: Any = []
    monkeypatch.setattr(channels, "quick_lines", lambda view, key, least: seen.append(view) or [len(seen)])
    assert channels.pick_ups(m) == [1, 2]
    view = seen[0]
    assert np.flatnonzero(view.ok).tolist() == [2, 4, 6] and view.filter.sigma == 1.25
    assert view.columns["current"] is current and view.columns["position"] is m.columns["position"]
    assert view.quanta == {"current": 0.2} and view.response.channel == "current"
    m.frame.get = lambda name: None
    assert channels.pick_ups(m) == []


def test_every_choice_is_collected_with_its_quotients(monkeypatch: pytest.MonkeyPatch) -> None:
    def retold(f: Finding, quotients: Any) -> Finding:
        return f.noted(f"times {quotients.get('k', 1.0)}")

    monkeypatch.setattr(axis_result, "finding_of", lambda s, k: Finding(s.chosen[k], "T", "time"))
    monkeypatch.setattr(axis_result, "NAMES", dict.fromkeys("ab", Some(retold=retold)))
    result: Any = axis_result.AxisResult(*[NOTHING] * 4)
    s: Any = Some(chosen=["a", "b"])
    result.collect(s, {"k": 2.0})
    result.collect(Some(chosen=["a"]))
    assert [(f.name, f.note) for f in result.findings] == [
        ("a", "times 2.0"), ("b", "times 2.0"), ("a", "times 1.0"),
    ]  # fmt: skip
    assert (result.constant_error, result.scale_error) == (0.0, 0.0)
    assert result.rng.random() == np.random.default_rng(0).random()
