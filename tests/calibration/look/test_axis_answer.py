"""The answer of an axis put together: logs that say nothing, titles, balances, domains, errors before."""

from pathlib import Path
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.decide.selection import Selection
from calibration.decide.thresholds import AXIS_EARNED
from calibration.finding import Finding, Parameter
from calibration.inputs.run import Run
from calibration.look import axis as answer
from calibration.look import looked
from calibration.look.looked import Balance, Options
from plant.units import ARCSEC
from tests.calibration.look.test_steps_and_events import noise, problem

axis: Any = answer
STEP_S = 0.01
TURN = 2 * np.pi


def run(rows: int = 600, span_s: float | None = None, travel: float = 1.0, **header: str) -> Run:
    """Rows that are spread over a span, going from 5 rad on."""
    t = np.linspace(0.0, rows * STEP_S if span_s is None else span_s, rows)
    x = np.linspace(0.0, travel, rows) + (5.0 if travel == 0 else 0.0)
    x[1] = np.nan
    scales = {"sample_period_s": STEP_S}
    return Run(
        "one", Path("one"), "one", {"t": t, "position": x}, header={"axis": "ra", **header}, scales=scales
    )


@pytest.mark.parametrize(
    ("runs", "why"),
    [
        ([run(599)], "599 rows (6.0 s) are too few to say anything (at least 600)"),
        ([run(300), run(300)], ""),
        ([run()], ""),
        ([run(600, 24.0)], ""),  # just a quarter of 2400
        ([run(600, 24.1)], "75 % of the samples are missing: what is left is not a motion"),
        ([run(travel=0.0)], "the axis does not move in these logs"),
        ([run(travel=0.99e-5)], "the axis does not move in these logs"),
        ([run(travel=1e-5)], ""),
        ([run(travel=0.0), run(travel=1e-4)], ""),
    ],
)
def test_logs_that_are_too_short_too_thin_or_at_rest_say_nothing(runs: list[Run], why: str) -> None:
    assert axis.too_little(runs) == why


def test_a_log_that_says_nothing_is_titled_and_says_so() -> None:
    emulated, table = Some(format="axis-log"), Some(format="table")
    short = [run(9, preload="high")]
    told = axis.look_at_axis(short, emulated, Options())
    assert told.title == "RA axis, high preload" and told.header is short[0].header
    assert told.needs == [axis.NEED] and told.notes == [axis.too_little(short)]
    assert axis.look_at_axis([run(9)], emulated, Options()).title == "RA axis, low preload"
    other = axis.look_at_axis([run(9)], table, Options())
    assert (other.title, other.header) == ("ra", None)


def selection(rows: int = 600, names: tuple[str, ...] = ()) -> Any:
    """Of a channel in which these names were chosen."""
    s = Selection.of(problem(noise(rows=rows)))
    return Some(problem=s.problem, candidates=[Some(name=n) for n in names], held=s.held, after=s.after)


def result(**fields: Any) -> Any:
    rows = np.arange(0, 1200, 2)
    x = np.linspace(0.0, 4 * TURN, 1200)
    motion = Some(x=x, rows=rows, speed=np.linspace(-9.0, 9.0, 1200) * ARCSEC)
    frame = Some(t=0.01 * np.arange(1200), train=Some(orders={"worm": 180.0}, ratio=10.0))
    given: dict[str, Any] = {
        "before": {}, "selections": {}, "views": {}, "floors": {}, "calibrated": {}, "findings": [],
        "refused": [], "held_out": ["end"], "torque": None, "declared": None,
    }  # fmt: skip
    return Some(**{"motion": motion, "frame": frame, **given, **fields})


@pytest.mark.parametrize("emulated", [True, False])
def test_an_axis_answer_is_made_of_channels_effects_and_what_they_lack(
    monkeypatch: pytest.MonkeyPatch, emulated: bool
) -> None:
    kept, gone = Finding("kept", "K", "time"), Finding("gone", "T", "time")
    found = result(selections={"T": "of T", "K": "of K"}, before={"K": 3.0}, findings=[kept, gone])
    found.refused = [("K", "x", "y")]
    withdrawn = [("T", "gone", "its control fits as well")]

    def balance(_: Any, key: str, s: Any, names: set[str]) -> Balance:
        assert s == f"of {key}" and names == {"kept", "gone"}
        return Balance(key=key, row=key, selection=s, controls=[{"of": key}])

    monkeypatch.setattr(axis, "analyse", lambda *_: found)
    monkeypatch.setattr(axis, "merge", lambda x: list(x))
    monkeypatch.setattr(axis, "_balance", balance)
    monkeypatch.setattr(axis, "failed_controls", lambda tried: [x["of"] for x in tried])
    monkeypatch.setattr(axis, "against_nature", lambda _: [])

    def withdraw(named: Any, failed: Any, _: Any) -> Any:
        assert failed == ["T", "K"]
        return [f for f in named if f is kept], withdrawn

    monkeypatch.setattr(axis, "withdraw", withdraw)
    monkeypatch.setattr(axis, "within_tolerance", lambda _, effects: {"T": float(len(effects))})
    monkeypatch.setattr(axis, "_with_missing", lambda _, b: b)
    monkeypatch.setattr(axis, "lacks", lambda *_: ["more"])
    monkeypatch.setattr(axis, "not_identifiable", lambda _: ["inertia"])
    monkeypatch.setattr(axis, "traces", lambda *_: [("T", "trace", "of another")])
    monkeypatch.setattr(looked, "unnamed_where_missing", lambda effects, needs, _: (effects, needs))
    runs = [run(), run()]
    runs[1].notes.append("noted")
    rig: Any = Some(format="axis-log" if emulated else "table")
    told = axis.look_at_axis(runs, rig, Options())
    assert [(b.key, b.before) for b in told.balances] == [("T", 1.0), ("K", 3.0)]
    assert told.effects == [kept] and told.needs == ["more", "gone was close, but its control fits as well"]
    assert told.refused == [*withdrawn, ("T", "trace", "of another"), ("K", "x", "y")]
    assert told.notes == [
        "noted",
        "channel S was not looked at: the log lacks the incremental encoder (velocity)",
    ]
    assert told.not_identifiable == ["inertia"] and told.held_out == ["end"]
    assert told.earned is (AXIS_EARNED if emulated else None)
    assert told.header is (runs[0].header if emulated else None)
    assert told.title == ("RA axis, low preload" if emulated else "ra") and told.axis is found


def balance(monkeypatch: pytest.MonkeyPatch, key: str, of: Any, names: set[str], s: Any) -> tuple[Any, Any]:
    asked: Any = []
    monkeypatch.setattr(axis, "tooth_more_or_less", lambda turns, span: (turns, span))
    monkeypatch.setattr(axis, "controls", lambda s, wrong: asked.append(wrong) or ["control"])
    monkeypatch.setattr(looked, "calibrated", lambda s, skip, error: {"volts": skip})
    return axis._balance(of, key, s, names), asked


def test_a_channel_has_its_row_numbers_floor_and_controls(monkeypatch: pytest.MonkeyPatch) -> None:
    s = selection(1200, ("worm", "other"))
    number = {"inertia": Parameter(1.0, "kg m2")}
    of = result(selections={"T": s, "K": s}, floors={"T": 0.5}, calibrated=number)
    b, asked = balance(monkeypatch, "T", of, {"worm"}, s)
    assert (b.row, b.floor, b.numbers, b.controls) == ("torque", 0.5, number, ["control"])
    ((turns, span),) = asked
    theta = np.linspace(0.0, 4.0, 1200)[::2]  # turns
    assert span == pytest.approx(theta[-1]) and turns == pytest.approx(np.concatenate([theta, theta]))
    assert b.spectrum is not None and b.spectrum.stages == {"worm": 180.0}
    assert b.spectrum.turns == pytest.approx(theta)
    assert b.over is not None and b.over(s)[1] == "time, s" and b.over(s)[0] is s.problem.t
    k, asked = balance(monkeypatch, "K", of, {"another"}, s)
    assert (k.numbers, k.controls, k.floor, asked, k.spectrum) == ({}, (), None, [], None)
    alone = result(selections={"K": s}, calibrated=number)
    assert balance(monkeypatch, "K", alone, set(), s)[0].numbers == number
    e, _ = balance(monkeypatch, "E", of, set(), s)
    assert e.numbers == {"volts": ("electrical_lag",)}
    u, asked = balance(monkeypatch, "U", of, {"worm"}, s)
    assert (u.row, asked[0][0]) == ("command", None)
    monkeypatch.setattr(axis, "place_of", lambda view, c: (view, c))
    seen, _ = balance(monkeypatch, "T", result(selections={"T": s}, views={"T": "view"}), set(), s)
    assert seen.over is not None and seen.over("c") == ("view", "c")


@pytest.mark.parametrize(("rows", "stacked", "there"), [(600, 1, True), (1200, 2, True), (700, 1, False)])
def test_a_residual_is_looked_for_over_angles_speed_and_time(
    monkeypatch: pytest.MonkeyPatch, rows: int, stacked: int, there: bool
) -> None:
    asked: Any = []
    monkeypatch.setattr(looked, "missing_over", lambda b, places, times: asked.append((places, times)))
    axis._with_missing(result(), Balance(key="T", row="torque", selection=selection(rows)))
    ((places, times),) = asked
    assert times == stacked and bool(places) == there
    if there:
        turn = np.linspace(0.0, 4.0, 1200)[::2]
        rate = np.linspace(-9.0, 9.0, 1200)[::2]  # arcsec/s
        wanted = {
            "axis_angle": turn, "velocity": np.sign(rate) * np.log(1 + np.abs(rate)),
            "time": 0.02 * np.arange(600), "motor_angle": 10 * turn - np.floor(10 * turn),
        }  # fmt: skip
        assert [p.domain for p in places] == list(wanted)
        for p in places:
            assert p.x == pytest.approx(np.tile(wanted[p.domain or ""], stacked), abs=1e-9)


def channel(asked: Any, compliance: float = 0.0) -> Any:
    """A balance whose declared model leaves what its held coefficients say."""
    p = Some(place=lambda name: {"compliance": 2}[name], holding=lambda fixed: asked.append(fixed) or fixed)
    return Some(problem=p, after=Some(beta=np.array([0.0, 0.0, compliance])))


@pytest.mark.parametrize(
    ("compliance", "held"),
    [(1e-3, 1e-2 / 1.3), (2e-2, 1.3e-2), (1.1e-2, 1.1e-2)],  # of 100 N m/rad, within its tolerance
)
def test_declared_numbers_that_are_others_are_held_within_their_tolerance(
    monkeypatch: pytest.MonkeyPatch, compliance: float, held: float
) -> None:
    monkeypatch.setattr(axis, "TOLERANCE", 1.3)
    monkeypatch.setattr(axis, "declared_residual", lambda fixed: np.array([3.0, 4.0]) * len(fixed))
    monkeypatch.setattr(axis, "held_numbers", lambda names, p, beta, *_: {7: 1.0} if "worn" in names else {})
    stiff = next(n for n, c in axis.CHANGES.items() if "stiffness" in c.numbers)
    soft = next(n for n, c in axis.CHANGES.items() if "stiffness" not in c.numbers)
    asked: Any = []
    t, k = channel(asked), channel(asked, compliance)
    both = result(selections={"T": t, "K": k}, torque=Some(friction=None), declared=Some(stiffness=100.0))

    def told(of: Any, *names: str) -> Any:
        return axis.within_tolerance(of, [Finding(n, "T", "time") for n in names])

    rms = np.sqrt(12.5)
    assert told(both, "worn", stiff) == {"T": pytest.approx(rms), "K": pytest.approx(rms)}
    assert asked == [{7: 1.0}, {2: pytest.approx(held)}]
    assert told(both, "other", soft) == {} and list(told(both, "worn", soft)) == ["T"]
    assert list(told(result(selections={"K": k}, declared=both.declared), "worn", stiff)) == ["K"]
    assert told(result(selections={"T": t}), "worn", stiff) == {}
    assert told(result(selections={}, torque=both.torque), "worn", stiff) == {}
