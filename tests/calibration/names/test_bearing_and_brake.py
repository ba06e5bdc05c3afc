"""Lines of no stage: which are looked for, how far they move, what they are called; a brake in a plant."""

from dataclasses import replace
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.inputs.declaration import GUESSED, Response, Stage
from calibration.inputs.train import MESH, OF_A_GUESS, SHAFT
from calibration.names import bearing_pass, brake_drag
from calibration.names.inplant import Facts
from tests.calibration.names.made import PERIOD_S, drive

lines: Any = bearing_pass
brakes: Any = brake_drag
FACTS = Facts("a.log")
ROWS = 2000
X = np.linspace(0.0, 10.0, ROWS)


def stage(
    name: str, period: float | None, harmonics: int = 1, kind: str | None = None, listed: Any = ()
) -> Stage:
    return Stage(name, period, None, harmonics, kind, listed)


def free(
    monkeypatch: pytest.MonkeyPatch, peaks: Any, *stages: Stage, pair: Any = None, **more: Any
) -> list[float]:
    """Rates that are offered, of those that stand out, over a travel of ten."""
    asked: Any = []
    s = drive(X, rig={"stages": stages}, **more)
    s = replace(s, pair=pair)
    monkeypatch.setattr(lines, "peaks_over_place", lambda s, most: asked.append(most) or list(peaks))
    monkeypatch.setattr(lines, "seen", lambda s, rate: rate != 7.0)
    monkeypatch.setattr(lines, "strongest", lambda s, weight, taken: [float(weight.sum()), *taken])
    monkeypatch.setattr(lines, "movable", lambda s, rate, within: [(rate, within)])
    found = lines.free_lines(s)
    assert asked in ([], [6])
    assert all(within == lines.between(rate, within_of(stages, pair), 10.0) for rate, within in found)
    return [rate for rate, _ in found]


def within_of(stages: Any, pair: Any) -> Any:
    least = 3 if pair is not None else 1
    return np.array([
        h / g.period for g in stages if g.period for h in g.listed or range(1, max(g.harmonics, least) + 1)
    ])  # fmt: skip


def test_a_line_is_free_a_third_of_a_cell_off_every_declared_one(monkeypatch: pytest.MonkeyPatch) -> None:
    worm = stage("worm", 2.0, 2)  # half a cycle per unit, and one
    peaks = (0.5, 0.534, 0.536, 0.966, 0.964, 1.034, 1.036, 1.5, 7.0)
    assert free(monkeypatch, peaks, worm, stage("none", None)) == [0.536, 0.964, 1.036, 1.5]
    assert free(monkeypatch, (0.5, 1.5), replace(worm, listed=(3,), harmonics=3)) == [0.5]
    assert free(monkeypatch, (0.5,)) == [0.5]
    assert free(monkeypatch, (0.5,), ok=np.zeros(ROWS, dtype=bool)) == []


def test_of_two_motors_the_strongest_lines_are_off_three_harmonics_at_least(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = free(monkeypatch, (), stage("worm", 2.0), stage("other", 4.0, 4), pair=Some())
    assert found == [ROWS, 0.5, 1.0, 1.5, 0.25, 0.5, 0.75, 1.0]


@pytest.mark.parametrize("taken", [None, (4.0,), (4.04,)])
def test_the_strongest_lines_are_tried_at_three_places(taken: Any) -> None:
    """Of 4 and 9 cycles a unit on half of the rows, of which the first may be a stage's."""
    y = 3.0 * np.cos(2 * np.pi * 4.0 * X) + 2.0 * np.cos(2 * np.pi * 9.0 * X)
    s = drive(X, residual=np.where(X > 5, np.nan, y), turn=20.0)
    s.problem.valid = X <= 5
    s.residual[X > 5] = 1e9
    known = None if taken is None else np.array(taken)
    found = lines.strongest(s, np.ones(ROWS), known)
    assert len(found) == 12 and found[1] - found[0] == pytest.approx(0.02) == found[2] - found[1]
    assert found[1] == pytest.approx(4.0, abs=0.06)
    assert (abs(found[1] - 4.0) > 0.034) == (taken == (4.0,))  # beside a third of a cell, which is a stage's
    apart = np.diff(found[1::3])
    assert np.abs(apart).min() > 0.149  # one and a half cells


@pytest.mark.parametrize(
    ("rate", "known", "low", "high"),
    [
        (1.0, (), 0.95, 1.05),  # half a cell of a travel of ten
        (1.0, (1.5, 0.5), 0.95, 1.05),
        (1.0, (0.94,), 0.975, 1.05),  # a third of a cell off a stage's
        (1.0, (1.04,), 0.95, 1.005),
        (1.0, (0.93, 1.08), 0.965, 1.045),
        (1.0, (0.99, 1.01), 1.025, 1.025),  # nowhere between them
        (1.0, (1.0,), 0.95, 0.965),
        (1.0, (0.899,), 0.95, 1.05),
    ],
)
def test_a_free_line_may_move_within_its_cell_and_not_to_a_stage_s(
    rate: float, known: tuple[float, ...], low: float, high: float
) -> None:
    got = lines.between(rate, np.array(known), 10.0)
    assert got == (pytest.approx(low), pytest.approx(max(low, high)))


def line(
    order: float, spread: float = 0.05, name: str = "bearing_pass", channel: str = "T", **more: Any
) -> Finding:
    f = Finding(name, channel, "axis_angle", order=order, **more)
    return f.having(
        order=Parameter(order, "1/turn", order - spread, order + spread), amplitude=Parameter(1, "N")
    )


def scene(*stages: Stage, turn: float | None = 360.0) -> Any:
    return drive(X, turn=turn, rig={"stages": stages}, unit="deg")


MOTOR, WORM = stage("motor", 36.0, 1, "motor"), stage("worm", 360.0, 12)


@pytest.mark.parametrize(
    ("order", "stages", "name", "of", "note"),
    [
        (14.37, (WORM, MOTOR), "bearing_pass", None, ""),
        (14.37, (WORM,), SHAFT, None, "no declared stage turns quicker"),  # no train
        (14.37, (), SHAFT, None, "no gear table was given"),
        (180.0 + 0.37, (WORM, MOTOR), SHAFT, None, "no declared stage turns quicker"),
        (179.37, (WORM, MOTOR), "bearing_pass", None, ""),
        (0.29, (WORM, MOTOR), SHAFT, None, "every declared stage turns quicker"),
        (0.31, (WORM, MOTOR), "bearing_pass", None, ""),  # a cage turns at three tenths
        (20.0, (WORM, MOTOR), SHAFT, "motor", "the order's interval holds 2 times that of motor"),
        (14.0, (WORM, MOTOR), SHAFT, "worm", "the order's interval holds 14 times that of worm"),
    ],
)  # fmt: skip
def test_a_line_is_a_bearing_s_where_the_train_has_room_for_one(
    order: float, stages: Any, name: str, of: str | None, note: str
) -> None:
    f = lines.of_no_stage(line(order, equivalent=("x", name)), scene(*stages))
    assert (f.name, f.stage) == (name, of) and f.note.startswith(f"period {360 / order:.5g} deg")
    assert note in f.note and ("; " in f.note) == bool(note)
    if name == "bearing_pass":
        return
    assert list(f.equivalent) == ["x", *(n for n in OF_A_GUESS if n != SHAFT), "bearing_pass"]
    assert f.harmonic == (round(order * (0.1 if of == "motor" else 1)) if of else None)
    assert ("order" in f.parameters) == (of is None) and "amplitude" in f.parameters
    assert ("cannot be named" in f.note) == (of is None)


def test_other_lines_and_those_without_an_order_stay() -> None:
    other, none = line(14.0, name="gear_mesh"), Finding("bearing_pass", "T", "axis_angle")
    assert lines.of_no_stage(other, scene(WORM)) is other and lines.of_no_stage(none, scene(WORM)) is none
    plain = lines.of_no_stage(line(0.5), scene(turn=None))
    assert plain.note.startswith("period 2 deg")
    two = lines.of_no_stage(line(14.37, channel="K"), scene())
    assert list(two.equivalent) == [MESH, "bearing_pass"]  # two sensors see no magnets


@pytest.mark.parametrize(
    ("order", "spread", "stages", "found"),
    [
        (20.0, 0.05, (WORM, MOTOR), ("motor", 2)),  # the quickest
        (20.0, 1.1, (WORM, MOTOR), (None, 0)),  # as wide as a fifth of the motor's turn
        (20.0, 0.9, (MOTOR,), ("motor", 2)),
        (20.4, 0.5, (MOTOR,), ("motor", 2)),
        (20.4, 0.3, (MOTOR,), (None, 0)),
        (0.04, 0.05, (WORM,), (None, 0)),  # a half is no harmonic
        (0.97, 0.05, (WORM,), ("worm", 1)),
        (20.0, 0.05, (stage("none", None), MOTOR), ("motor", 2)),
    ],
)
def test_a_harmonic_is_a_whole_multiple_within_a_narrow_interval(
    order: float, spread: float, stages: Any, found: Any
) -> None:
    of, harmonic = lines._harmonic_of(line(order, spread), scene(*stages))
    assert (of and of.name, harmonic) == found
    open_ = Finding("bearing_pass", "T", "axis_angle", parameters={"order": Parameter(20.0, "", None, 21.0)})
    assert lines._harmonic_of(open_, scene(MOTOR)) == (None, 0)
    assert lines._harmonic_of(Finding("bearing_pass", "T", "axis_angle"), scene(MOTOR)) == (None, 0)


@pytest.mark.parametrize(
    ("kind", "channel", "name"),
    [
        ("motor_cogging", "T", "motor_cogging"), ("motor_cogging", "K", SHAFT), (None, "T", SHAFT),
        ("strange", "T", SHAFT), (GUESSED, "T", SHAFT),
    ],
)  # fmt: skip
def test_a_stage_s_line_is_called_by_its_kind(kind: str | None, channel: str, name: str) -> None:
    assert lines._called(stage("s", 1.0, 1, kind), line(1.0, channel=channel)) == name
    assert lines._called(None, line(1.0, channel=channel)) == SHAFT


@pytest.mark.parametrize(("kind", "name", "guessed"), [
    (GUESSED, SHAFT, True), (None, SHAFT, False), (GUESSED, "gear_mesh", False),
])  # fmt: skip
def test_a_guessed_stage_s_line_has_other_names(kind: str | None, name: str, guessed: bool) -> None:
    f = line(1.0, name=name, stage="s", equivalent=("x",))
    told = lines.of_a_guess(f, scene(stage("s", 1.0, 1, kind), stage("t", 1.0, 1, GUESSED)))
    assert told is f or guessed
    if guessed:
        assert list(told.equivalent) == ["x", *(n for n in OF_A_GUESS if n != SHAFT)]


def test_a_bearing_in_a_plant_takes_torque_that_the_motors_give() -> None:
    """Motors add A cos(x + p); the axis has minus that, A sin(x + p - 90 degrees)."""
    f = line(7.0).having(amplitude=Parameter(2.0, "N m"), phase=Parameter(0.5, "rad"))
    (effect,) = bearing_pass.NAME.to_plant(f, FACTS).effects
    numbers = {k: n.value for k, n in effect.parameters.items()}
    assert (numbers["amplitude"], numbers["order"]) == (2.0, 7.0)
    assert numbers["phase"] == pytest.approx(0.5 - np.pi / 2)


def test_lines_of_a_pair_are_of_its_torque(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lines, "free_lines", lambda s: ["line"])
    columns = bearing_pass.NAME.columns
    for pair, force, there in ((None, True, True), (None, False, True), (1, True, True), (1, False, False)):
        assert bool(columns(Some(pair=pair, force=force))) == there  # type: ignore[arg-type]


def drag(torque: float, start: str = "start", name: str = "brake_drag", **more: Any) -> Finding:
    parameters = {"torque": Parameter(torque, "N m"), start: Parameter(7.0, "s")}
    return Finding(name, "T", "time", parameters=parameters, **more)


def test_a_drag_that_goes_away_was_there_from_the_start() -> None:
    on, off = (brake_drag.to_plant(drag(x), FACTS) for x in (2.0, -2.0))
    numbers = {k: n.value for k, n in on.effects[0].parameters.items()}
    assert (numbers["torque"], numbers["start"]) == (2.0, 7.0) and on.numbers == {}
    assert not any("lets go" in r for r in on.remarks)
    values = {k: n.value for k, n in off.effects[0].parameters.items()}
    assert values["torque"] == 2.0 and values["start"] <= 0.0
    assert off.numbers == {"friction.coulomb": -2.0, "friction.stiction": -2.0}
    assert off.remarks[-1] == "brake_drag: it lets go, so Tc and Ts of the plant are those without it"
    nothing = brake_drag.to_plant(drag(0.0), FACTS)
    assert nothing.numbers == {}
    again = brake_drag.to_plant(drag(2.0, "start_in_run"), FACTS)
    assert again.effects[0].parameters["start"].value == 7.0


BOTH = np.sin(2 * np.pi * PERIOD_S * np.arange(ROWS) / 4)


def one_way(f: Finding, speed: Any = 1.0, both: bool = False, pair: Any = None) -> Finding:
    n = np.arange(ROWS)
    s = drive(BOTH if both else X, response=Response("force", "N"), speed=speed * np.ones(ROWS),
              direction=np.where(n % 100 < 50, 1.0, -1.0) if both else np.ones(ROWS))  # fmt: skip
    told: Finding = brakes.one_way(f, replace(s, pair=pair))
    return told


VARIED = 1.0 + 0.31 * np.resize([1.0, -1.0], ROWS)
OFFSET = drag(2.0, equivalent=("x", UNKNOWN))


@pytest.mark.parametrize(
    ("f", "given", "unknown"),
    [
        (drag(2.0), {}, True),
        (drag(2.0), {"both": True}, False),
        (drag(2.0), {"pair": 1}, False),
        (drag(2.0), {"speed": VARIED}, True),  # a brake is the same at every speed
        (drag(2.0, name="friction_warmup"), {}, True),
        (drag(2.0, name="friction_warmup"), {"speed": VARIED}, False),
        (drag(2.0, name="friction_warmup"), {"speed": 1.0 + 0.97 * (VARIED - 1.0)}, False),
        (drag(2.0, name="friction_warmup"), {"speed": 1.0 + 0.96 * (VARIED - 1.0)}, True),
        (drag(2.0, name="preload_change"), {}, False),
        (replace(OFFSET, name="preload_change"), {"both": True}, True),
        (replace(OFFSET, name="friction_warmup"), {"both": True}, False),
        (OFFSET, {"both": True}, True),
        (drag(2.0, name="wind_torque"), {}, False),
    ],
)
def test_what_goes_one_way_may_be_an_offset_that_changes(
    f: Finding, given: dict[str, Any], unknown: bool
) -> None:
    told = one_way(f, **given)
    if not unknown:
        assert told == f
        return
    assert told.name == UNKNOWN and list(told.equivalent) == [
        f.name,
        *(x for x in f.equivalent if x != UNKNOWN),
    ]
    way = "" if given.get("both") else "one way only, "
    assert told.note == f"{way}an offset of the column that changes looks the same"
    assert bool(told.parameters) == (f.name != "friction_warmup")


@pytest.mark.parametrize(("torque", "less"), [(-1.0, True), (0.0, False), (1.0, False)])
def test_less_drag_has_other_names(torque: float, less: bool) -> None:
    told = one_way(drag(torque, equivalent=("preload_change",)), both=True)
    assert list(told.equivalent) == ["preload_change", *(["friction_warmup"] if less else [])]
    warm = one_way(drag(-1.0, name="friction_warmup"), both=True)
    assert list(warm.equivalent) == []
