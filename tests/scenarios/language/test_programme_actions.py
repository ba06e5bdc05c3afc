"""What each action of a scenario asks of the host, and what its record keeps."""

from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from bus.protocol import Device, Opcode, SpeedClass
from host.procedures import dome, focus, manual
from host.procedures.autoguide import Guiding
from host.sky.pointfit import TooFewStars
from scenarios.language import configure, programme
from scenarios.native.finder import compiled
from tests.scenarios.language.desk import Desk, Night

pytestmark = pytest.mark.skipif(compiled(), reason="no class of a test may derive from a compiled one")

RA, DEC = Device.AXIS_RA, Device.AXIS_DEC


class Noted:
    """Stands for a procedure: it keeps its arguments and ends at once."""

    def __init__(self) -> None:
        self.given: tuple[Any, ...] = ()

    def __call__(self, *given: Any) -> Iterator[None]:
        self.given = given
        return iter(())


@pytest.fixture
def noted() -> Noted:
    return Noted()


@pytest.mark.parametrize(("step", "where", "name", "given"), [
    ("power_on: {}", manual, "power_on", (True,)),
    ("power_on: {health_check: false}", manual, "power_on", (False,)),
    ("move: {axis: dec, class: set, direction: '-', for: 3 s}", manual, "hold_button",
     ("dec", "set", "-", 3.0)),
    ("set_rate: {axis: ra, rate: -1 arcmin/s, for: 3 s}", manual, "set_rate", ("ra", -60.0, 3.0)),
    ("open_loop: {axis: ra, effort: 5 %, for: 1 min}", manual, "open_loop", ("ra", 0.05, 60.0)),
    ("stop: {}", manual, "stop", ("both",)), ("stop: {axis: dec}", manual, "stop", ("dec",)),
    ("power_off: {}", manual, "power_off", ()),
    ("dome: {azimuth: 90 deg}", dome, "turn", (90.0,)),
    ("dome: {shutter: open}", dome, "shutter", (True,)),
    ("dome: {shutter: closed}", dome, "shutter", (False,)),
    ("focus: {to: 40}", focus, "move_to", (40.0,)), ("focus: {by: -3}", focus, "step_by", (-3.0,)),
    ("focus: {state: free}", focus, "set_state", ("free",)),
    ("focus: {reference: true}", focus, "reference", ()),
])  # fmt: skip
def test_an_action_asks_the_host(
    step: str, where: Any, name: str, given: tuple[Any, ...], noted: Noted, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(where, name, noted)
    boards: list[Any] = [*Device, SimpleNamespace(name="DOME")]
    desk = Desk(*boards)
    night = Night(step, desk=desk).run(0)
    assert noted.given == (desk, *(pytest.approx(g) if isinstance(g, float) else g for g in given))
    assert night.programme.finished and not night.programme.failed


@pytest.mark.parametrize(("step", "asked"), [
    ("set_parameter: {node: AXIS_RA, parameter: 2, value: -7}", (RA, Opcode.SET_PARAMETER, 2, -7)),
    ("display: {brightness: 30}", (Device.DISPLAY, Opcode.BRIGHTNESS, 30)),
    ("move: {axis: ra, class: fine, direction: +, for: 1 s}", (RA, Opcode.SET_CLASS, SpeedClass.FINE, 1)),
])  # fmt: skip
def test_an_action_is_a_command(step: str, asked: tuple[Any, ...]) -> None:
    assert Night(step).run(3).desk.asked[0] == asked


@pytest.mark.parametrize(("step", "board"), [
    ("display: {brightness: 1}", "DISPLAY"), ("dome: {shutter: open}", "DOME"),
    ("set_parameter: {node: FOCUS, parameter: 1, value: 1}", "FOCUS"),
])  # fmt: skip
def test_a_board_that_is_not_there_fails_the_step(step: str, board: str) -> None:
    night = Night(step, desk=Desk(RA, DEC)).run(0)
    assert night.programme.records[0].failed == f"{board} is not on this network"


@pytest.mark.parametrize(("step", "place", "goal"), [
    ("focus: {to: 40}", None, 40.0), ("focus: {by: -3}", SimpleNamespace(position=10), 7.0),
    ("focus: {by: 3}", None, None), ("focus: {state: hold}", SimpleNamespace(position=10), None),
])  # fmt: skip
def test_a_focus_steps_goal_is_kept(step: str, place: Any, goal: float | None) -> None:
    desk = Desk()
    desk.place = place
    assert Night(step, desk=desk).run(0).programme.records[0].focus_goal == goal


def test_a_firmware_goes_to_both_axes_and_a_table_to_its_own() -> None:
    night = Night("wait: {for: 1 s}")
    table = configure.Compensation("dec", (), 1.0, 1.0)
    steps = [
        SimpleNamespace(action="firmware", arguments={"of_axes": {"ra": {3: 4}, "dec": {5: 6}}}),
        SimpleNamespace(action="compensation", arguments={"table": table}),
    ]
    for step in steps:
        night.programme.records[0] = programme.Record(step)  # type: ignore[arg-type]
        for _ in night.programme._procedure(0, 0.0):
            pass
    first, second, *others = night.desk.asked
    put = Opcode.SET_PARAMETER
    assert [first, second] == [(RA, put, 3, 4), (DEC, put, 5, 6)]
    assert others == [(DEC, put, *row) for row in table.parameters()]


@pytest.mark.parametrize(("words", "classes"), [
    ("", ("slew", "set", "guide", "fine")), (", classes: [set, fine]", ("set", "fine")),
])  # fmt: skip
def test_a_goto_keeps_its_star(
    words: str, classes: tuple[str, ...], noted: Noted, monkeypatch: pytest.MonkeyPatch
) -> None:
    night = Night(f"goto: {{target: Pollux{words}}}", "park: {}")
    monkeypatch.setattr(night.programme.pointing, "goto", noted)
    monkeypatch.setattr(night.programme.pointing, "park", lambda: iter(()))
    track, asked = [night.run(0), *noted.given][1:]
    assert track.star.name == "Pollux" and asked == classes
    assert night.programme.records[0].star == track.star
    assert night.run(1).programme.finished


def test_a_star_below_the_horizon_fails_the_step() -> None:
    night = Night("goto: {target: Pollux}")
    night.programme._scenario = replace(night.programme._scenario, horizon_rad=1.5)
    failed = night.run(0).programme.records[0].failed
    assert failed and night.programme.failed


@pytest.mark.parametrize("track", [None, SimpleNamespace(star="a star")])
def test_tracking_and_guiding_know_the_star(track: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    night = Night("track: {for: 8 s}", "autoguide: {for: 9 s}")
    seen: list[Any] = []

    def follow(seconds: float) -> Iterator[None]:
        seen.append(seconds)
        return iter(())

    def guide(pointing: object, _scenario: object, eye: object, how: Guiding, told: Any) -> Iterator[None]:
        seen.append((pointing is night.programme.pointing, eye is night.eye, how.seconds))
        told("first")
        told("second")
        return iter(())

    night.programme.pointing.track = track
    monkeypatch.setattr(night.programme.pointing, "follow", follow)
    monkeypatch.setattr(programme, "autoguide", guide)
    records = night.run(1).programme.records
    assert seen == [8.0, (True, True, 9.0)]
    assert [each.star for each in records] == [track and track.star] * 2
    told: Any = records[1].guided
    assert told == ("first", "second")


def test_guiding_has_the_published_defaults() -> None:
    """As the schema tells: 2 s, 70 %, at the encoder."""
    assert programme.guiding_of({"for": 5.0}) == Guiding(
        seconds=5.0, exposure_s=2.0, aggressiveness=0.7, by_rate=False
    )
    given = {"for": 5.0, "exposure": 1.0, "aggressiveness": 0.5, "by": "rate"}
    assert programme.guiding_of(given) == Guiding(
        seconds=5.0, exposure_s=1.0, aggressiveness=0.5, by_rate=True
    )


@pytest.mark.parametrize(("words", "count", "fits"), [
    ("", 40, True), ("stars: 9", 9, True), ("fit: false", 40, False)
])  # fmt: skip
def test_a_pointing_run_points_by_what_it_found(
    words: str, count: int, fits: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    night = Night("wait: {for: 1 s}", f"pointing_run: {{{words}}}")
    model: Any = SimpleNamespace()
    seen: list[Any] = []

    def fit(*given: Any) -> Any:
        seen.append(given)
        return model

    def visit(_pointing: object, _scenario: object, where: Any, eye: object) -> Any:
        seen.append((*where, eye is night.eye))
        yield
        return (SimpleNamespace(sighting="seen"),)

    monkeypatch.setattr(programme, "directions", lambda count, _scenario, turn: (count, turn))
    monkeypatch.setattr(programme, "visit", visit)
    monkeypatch.setattr(programme, "fit", fit)
    before = night.programme._scenario.mount
    record = night.run(3).programme.records[1]
    assert seen[0] == (count, 1.0, True) and len(record.visits) == 1
    assert night.programme.finished and (record.model is model) is fits
    if fits:
        assert seen[1] == (["seen"], before, night.programme._scenario.site.latitude_rad)
    now = night.programme._scenario.mount
    assert now is night.programme.pointing.mount and (now.model is model) is fits


def test_too_few_stars_fail_the_step(monkeypatch: pytest.MonkeyPatch) -> None:
    def none(*_: object) -> None:
        raise TooFewStars("too few")

    def visit(*_: object) -> Any:
        yield
        return ()

    monkeypatch.setattr(programme, "visit", visit)
    monkeypatch.setattr(programme, "fit", none)
    night = Night("pointing_run: {stars: 6}").run(1)
    assert night.programme.records[0].failed == "too few"
