"""All checks in their order, a board that is not there, and the halt at the end, however they end."""

from collections.abc import Callable, Sequence
from itertools import count
from pathlib import Path

import can
import pytest

from bus.conformance import Board, CheckResult, Settings, board_of, parse, run
from bus.conformance.run import declared_halt, halt, halted
from bus.protocol import Device, Opcode
from bus.protocol.nodes import DEVICES, Kind
from bus.protocol.nodes import DOME as DOME_KIND
from tests.conformance.canopen_node import Node
from tests.conformance.scripted import (
    AXIS,
    DISPLAY,
    FOCUS,
    GATEWAY,
    Coming,
    ScriptedBus,
    board,
    declared,
    frame,
    link_on,
    silence,
    told,
)

DOME = declared("DOME", DEVICES)
STOP, OFF = "091: 11 11 00 00 00 00 00 00", "091: 11 10 00 00 00 00 00 00"
HOLD, DOME_STOP = "0c1: 41 22 00 00 00 00 00 00", "0f1: 71 42 00 00 00 00 00 00"
PING = "0d1: 51 01 00 00 00 00 00 00"


@pytest.fixture
def bus(monkeypatch: pytest.MonkeyPatch) -> ScriptedBus:
    """One by whose clock the checks go."""
    made = ScriptedBus()
    monkeypatch.setattr("bus.conformance.link.monotonic", lambda: made.now_s)
    return made


def checked(bus: ScriptedBus, devices: Sequence[Device | Board], **settings: object) -> list[CheckResult]:
    return run(bus, devices=devices, settings=Settings(**settings))  # type: ignore[arg-type]


def test_all_checks_in_their_order(bus: ScriptedBus) -> None:
    bus.answer = board(0x51)
    seen: list[CheckResult] = []
    results = checked(bus, [Device.DISPLAY], each=seen.append, flood=True)
    assert seen == results
    assert list(dict.fromkeys(each.check for each in results)) == [
        "identifier", "undocumented", "command", "health", "wrong length", "wrong device type",
        "unknown opcode", "out of range", "unknown identifier", "extended frame", "remote frame",
        "still there", "limits", "response time", "flooding", "full bus",
    ]  # fmt: skip
    assert {each.subject.partition(" ")[0].rstrip(",") for each in results} == {
        "DISPLAY_HEARTBEAT", "bus", "DISPLAY",
    }  # fmt: skip


def test_a_state_is_checked_before_limits(bus: ScriptedBus) -> None:
    bus.answer = board(0x11)
    checks = list(dict.fromkeys(each.check for each in checked(bus, [AXIS])))
    assert checks[-4:] == ["wrong state", "limits", "response time", "flooding"]


def test_a_board_that_is_not_there_is_asked_twice(bus: ScriptedBus) -> None:
    found = told(checked(bus, [GATEWAY, DISPLAY], reply_s=0.25))
    said = "error answers: {} PING: a reply | none, twice"
    assert found[-2:] == [said.format("GATEWAY"), said.format("DISPLAY")]
    assert bus.lines() == ["0e1: 61 01 00 00 00 00 00 00"] * 2 + [PING] * 2


def test_what_came_instead_is_told_and_an_answer_at_the_second_time_is_enough(bus: ScriptedBus) -> None:
    numbers = count()

    def late(message: can.Message) -> Coming:
        return board(0x51)(message) if next(numbers) else [(0.0, frame(0x191, bytes(8)))]

    bus.answer = lambda _: [(0.0, frame(0x191, bytes(8)))]
    observed = "none, twice; answered with 0x191 instead of 0x151"
    assert checked(bus, [DISPLAY])[-1].observed == observed
    bus.answer = late
    assert "answers" not in {each.check for each in checked(bus, [DISPLAY])}


def test_by_default_every_board_of_the_protocol_is_expected(bus: ScriptedBus) -> None:
    bus.answer = silence
    missing = [each.subject for each in run(bus) if each.check == "answers"]
    assert missing == [f"{device.name} PING" for device in Device]


def test_canopen_is_checked_alone(bus: ScriptedBus) -> None:
    bus.answer = Node(0x51)
    checks = {each.check for each in checked(bus, [DISPLAY], canopen=True, stamps_s=0.0)}
    assert "boot-up" in checks and not {"identifier", "answers", "command"} & checks


def test_a_declared_boards_stop_is_found_by_its_name() -> None:
    assert [(opcode.name, arguments) for opcode, arguments in declared_halt(DOME)] == [("DOME_STOP", ())]
    assert declared_halt(declared("POWER_ROOM", DEVICES)) == declared_halt(GATEWAY) == ()


def test_a_stop_has_no_arguments_and_what_has_none_is_not_a_stop(tmp_path: Path) -> None:
    text = DOME_KIND.dbc.read_text(encoding="utf-8")
    path = tmp_path / "dome.dbc"
    text = text.replace('"DOME_GOTO"', '"DOME_GOTO_STOP"').replace('66 "', '67 "DOME_HOME" 66 "')
    path.write_text(text, encoding="utf-8")
    kind = Kind("DOME", {"DOME": 0x71}, path)
    found = declared_halt(board_of(kind.device("DOME")))
    assert [opcode.name for opcode, _ in found] == ["DOME_STOP"]


def test_everything_is_halted_twice() -> None:
    bus = ScriptedBus()
    halt(link_on(bus), [AXIS, FOCUS, DISPLAY, DOME])
    assert bus.lines() == [STOP, OFF, HOLD, DOME_STOP] * 2
    assert bus.now_s == 0.05


def raising(at: dict[int, BaseException]) -> Callable[[can.Message], Coming]:
    """Raise these errors at these frames."""
    numbers = count()

    def answer(_message: can.Message) -> Coming:
        if error := at.get(next(numbers)):
            raise error
        return ()

    return answer


def test_an_interrupt_meanwhile_is_told_once_all_are_halted() -> None:
    bus = ScriptedBus(raising({1: KeyboardInterrupt()}))
    with pytest.raises(KeyboardInterrupt):
        halt(link_on(bus), [AXIS])
    assert bus.lines() == [STOP, OFF, OFF, STOP, OFF]
    assert bus.now_s == 0.0


def test_a_bus_that_is_broken_is_told_once_all_has_been_tried() -> None:
    bus = ScriptedBus(raising({0: can.CanError("first"), 2: can.CanError("last")}))
    with pytest.raises(can.CanError, match="last"):
        halt(link_on(bus), [AXIS])
    assert bus.lines() == [STOP, OFF, STOP, OFF]


@pytest.mark.parametrize(
    ("motion", "sent"), [(True, [STOP, OFF] * 2), (False, [])], ids=["motion", "no motion"]
)
def test_only_what_was_asked_to_move_is_halted(motion: bool, sent: list[str]) -> None:
    for error in (None, ValueError("first"), KeyboardInterrupt("first")):
        bus = ScriptedBus(raising({1: can.CanError("then")}) if error else silence)
        link = link_on(bus, motion=motion)
        if error is None:
            with halted(link, [AXIS]):
                assert bus.sent == []
        else:
            with pytest.raises(type(error), match="first"), halted(link, [AXIS]):
                raise error
        assert bus.lines() == sent


def test_a_run_that_moves_ends_in_a_halt(bus: ScriptedBus) -> None:
    bus.answer = board(0x13)
    run(bus, devices=[parse("axis:0x13")], settings=Settings(motion=True))
    assert [bytes(each.data[:3]) for each in bus.sent[-4:]] == [
        bytes((0x13, opcode, 0)) for opcode in (Opcode.STOP, Opcode.POWER) * 2
    ]
