"""The answer to each command: what is sent to which board, and how an answer is judged, word by word."""

import pytest

from bus.conformance import Board
from bus.conformance.commands import asked, check_answers, check_commands, declared_cases, judge
from bus.conformance.link import Answers
from bus.protocol import Device, Opcode, Reply, Result
from bus.protocol.nodes import DEVICES
from tests.conformance.scripted import (
    AXIS,
    DISPLAY,
    GATEWAY,
    OK,
    OUTSIDE,
    REFUSED,
    ScriptedBus,
    Store,
    Verdict,
    board,
    declared,
    link_on,
    told,
    wrong,
)

DOME = declared("DOME", DEVICES)
POWER = declared("POWER_ROOM", DEVICES)
AUXILIARY = declared("AUXILIARY_RA", DEVICES)


@pytest.mark.parametrize(
    ("replies", "parameter", "results", "passed", "observed"),
    [
        ([(0x51, 1, OK, 0, 0)], None, (OK,), True, "OK"),
        ([(0x51, 1, OK, 0, 3)], None, (OK,), True, "OK value 3"),
        ([(0x51, 1, OK, 9, -1)], None, (OK,), True, "OK value -1"),
        ([(0x51, 1, REFUSED, 0, 0)], None, (OK, REFUSED), True, "NOT_ALLOWED"),
        ([(0x51, 1, REFUSED, 0, 0)], None, (OK,), False, "NOT_ALLOWED"),
        ([(0x51, 1, 6, 0, 0)], None, (OK,), False, "result 6"),
        ([(0x51, 1, 255, 0, 0)], None, (OK,), False, "result 255"),
        ([(0x52, 1, OK, 0, 0)], None, (OK,), False, "OK from device type 0x52"),
        ([(0x07, 1, OK, 0, 2)], None, (OK,), False, "OK value 2 from device type 0x07"),
        ([(0x51, 1, OK, 0, 0)] * 2, None, (OK,), False, "OK, OK"),
        ([], None, (OK,), False, "no reply"),
        ([(0x51, 2, OK, 7, 5)], 7, (OK,), True, "OK value 5"),
        ([(0x51, 2, OK, 8, 5)], 7, (OK,), False, "OK value 5 of parameter 8"),
        ([(0x52, 2, OK, 8, 0)], 7, (OK,), False, "OK of parameter 8 from device type 0x52"),
        ([], 7, (OK,), False, "no reply"),
    ],
)
def test_one_answer_of_the_board_itself_that_fits(
    replies: list[tuple[int, ...]],
    parameter: int | None,
    results: tuple[int, ...],
    passed: bool,
    observed: str,
) -> None:
    answers = Answers(Reply(*each) for each in replies)
    answers.parameter = parameter
    result = judge("command", "X", answers, 0x51, results, 0.25)
    expected = "one reply: OK or NOT_ALLOWED" if len(results) > 1 else "one reply: OK"
    expected += "" if parameter is None else " of parameter 7"
    assert (result.check, result.subject, result.duration_s) == ("command", "X", 0.25)
    assert (result.level == "ok", result.expected, result.observed) == (passed, expected, observed)


def test_what_came_instead_of_an_answer_is_told() -> None:
    answers = Answers()
    answers.instead = "answered with 0x191 instead of 0x151"
    result = judge("command", "X", answers, 0x51, (OK,), 0.0)
    assert result.observed == "no reply; answered with 0x191 instead of 0x151"
    answers.append(Reply(0x51, 1, OK, 0, 0))
    assert judge("command", "X", answers, 0x51, (OK,), 0.0).observed == "OK"


def test_any_bytes_are_asked_and_timed() -> None:
    bus = ScriptedBus(board(0x51, lambda _: (Result.WRONG_LENGTH, 0, 0), after_s=0.25), now_s=8.0)
    result = asked(link_on(bus, quiet_s=0.5), DISPLAY, "wrong length", "X", b"\x51", (Result.WRONG_LENGTH,))
    assert told([result]) == ["ok wrong length: X: one reply: WRONG_LENGTH | WRONG_LENGTH"]
    assert result.duration_s == 0.75


COMMON = ("PING", "GET_PARAMETER 1", "SET_PARAMETER 1")
STILL = (
    "POWER 0", "STOP", "SET_RATE 0", "SET_CLASS 4 0", "TRACK_RATE 0", "OPEN_LOOP 0", "NUDGE 0", "MOVE_TO 0 4",
)  # fmt: skip
MOVING = (
    "POWER 1", "SET_RATE 0", "SET_CLASS 3 1", "TRACK_RATE 0", "NUDGE 100", "OPEN_LOOP 0", "STOP", "POWER 0",
)  # fmt: skip


@pytest.mark.parametrize(
    ("checked", "motion", "commands", "withheld"),
    [
        (AXIS, False, STILL, 8),
        (AXIS, True, STILL + MOVING, 0),
        (DISPLAY, False, ("BRIGHTNESS 100",), 0),
        (GATEWAY, False, (), 0),
        (DOME, False, (), 3),
        (DOME, True, ("DOME_GOTO 35999", "DOME_SHUTTER 1", "DOME_STOP"), 0),
        (POWER, True, ("RELAY 8 1",), 0),
        (POWER, False, (), 1),
        (AUXILIARY, False, (), 0),
    ],
    ids=lambda value: value.name if isinstance(value, Board) else "",
)
def test_every_command_that_a_board_knows_is_sent(
    checked: Board, motion: bool, commands: tuple[str, ...], withheld: int
) -> None:
    bus = ScriptedBus(board(checked.device, Store({1: (3, 30)})))
    results = list(check_commands(link_on(bus, motion=motion), checked))
    found = [each.subject.removeprefix(f"{checked.name} ") for each in results if each.check == "command"]
    assert found == [*COMMON, *commands]
    opcodes = [Opcode[name.split()[0]] for name in found if name.split()[0] in Opcode.__members__]
    assert [each.data[1] for each in bus.sent if each.data[1] in set(Opcode)] == opcodes
    assert bytes(bus.sent[2].data) == bytes((checked.device, 3, 1, 30, 0, 0, 0, 0))
    said = f"{withheld} commands that may move something not sent; --motion sends them"
    motion_lines = [f"info motion: {checked.name}:  | {said}"] if withheld else []
    assert told(each for each in results if each.check == "motion") == motion_lines


def test_a_parameter_that_was_not_read_is_not_written() -> None:
    bus = ScriptedBus(board(POWER.device, lambda data: None if data[1] == 2 else (OK, 0, 0)))
    lines = wrong(check_commands(link_on(bus), POWER))
    assert lines == ["error command: POWER_ROOM GET_PARAMETER 1: one reply: OK of parameter 1 | no reply"]
    assert [each.data[1] for each in bus.sent] == [1, 2]


def test_what_is_declared_is_asked_at_its_upper_limits_and_may_be_refused() -> None:
    goto, shutter, stop = declared_cases(DOME.model)
    assert [each.arguments for each in (goto, shutter, stop)] == [(35999,), (1,), ()]
    assert all(each.results == (OK, REFUSED) and each.moves for each in (goto, shutter, stop))
    assert declared_cases(Device.GATEWAY) == ()


@pytest.mark.parametrize(
    ("checked", "verdict", "expected"),
    [
        (DISPLAY, (OUTSIDE, 1, 0), None),
        (AUXILIARY, (OUTSIDE, 1, 0), None),
        (DISPLAY, (REFUSED, 1, 0), "OK or OUT_OF_RANGE"),
        (AXIS, (OUTSIDE, 1, 0), "OK"),
        (DOME, (OUTSIDE, 1, 0), "OK"),
    ],
    ids=str,
)
def test_only_a_board_without_parameters_may_have_none(
    checked: Board, verdict: Verdict, expected: str | None
) -> None:
    bus = ScriptedBus(board(checked.device, lambda data: verdict if data[1] in (2, 3) else (OK, 0, 0)))
    lines = wrong(check_commands(link_on(bus), checked))
    name, said = checked.name, f"one reply: {expected} of parameter 1 | {Result(verdict[0]).name}"
    subjects = ("GET_PARAMETER 1", "SET_PARAMETER 1") if expected else ()
    wanted = [f"error command: {name} {subject}: {said}" for subject in subjects]
    assert [line for line in lines if "PARAMETER" in line] == wanted


@pytest.mark.parametrize(
    ("health", "line"),
    [
        (0, "ok health: DISPLAY: 0 | 0x0"),
        (0x80, "ok health: DISPLAY: 0 | 0x80"),
        (0x01, "issue health: DISPLAY: 0 | 0x1"),
        (0x90, "issue health: DISPLAY: 0 | 0x90"),
        (0x100, "issue health: DISPLAY: 0 | 0x100"),
        (None, "issue health: DISPLAY: 0 | no reply"),
    ],
)
def test_health_is_nought_but_for_frames_of_the_testers_own(health: int | None, line: str) -> None:
    bus = ScriptedBus(
        board(0x51, lambda _: None if health is None else (OK, 0, health), after_s=0.25), now_s=8.0
    )
    results = list(check_commands(link_on(bus, quiet_s=0.25, reply_s=0.5), DISPLAY))
    assert told(results[1:2]) == [line]
    assert [each.duration_s for each in results if each.check == "command"] == [0.5] * len(bus.sent)


@pytest.mark.parametrize(
    ("took", "settings", "level", "allowed", "observed"),
    [
        ([(0.25, 1)], {"answer_s": 0.25}, "ok", "250", "250.000..250.000 ms, 1 answers, the slowest to PING"),
        ([(0.25, 1), (0.5, 48), (0.375, 2)], {"answer_s": 0.25, "stamps_s": 0.125}, "error", "375",
         "250.000..500.000 ms, 3 answers, the slowest to BRIGHTNESS"),
        ([(0.25, 1), (0.125, 126)], {"answer_s": 0.25, "stamps_s": 0.125, "speed": 2.0}, "ok", "500",
         "250.000..500.000 ms, 2 answers, the slowest to PING"),
        ([(0.5, 126), (0.125, 1)], {"answer_s": 0.25}, "error", "250",
         "125.000..500.000 ms, 2 answers, the slowest to opcode 0x7e"),
        ([(0.5, 4)], {"answer_s": 0.5}, "ok", "500",
         "500.000..500.000 ms, 1 answers, the slowest to opcode 0x04"),
    ],
)  # fmt: skip
def test_the_slowest_answer_is_within_two_control_periods(
    took: list[tuple[float, int]], settings: dict[str, float], level: str, allowed: str, observed: str
) -> None:
    link = link_on(ScriptedBus(), **{"stamps_s": 0.0} | settings)
    link.took_s = {0x51: took, 0x11: [(9.0, 1)], 0x61: []}
    line = f"{level} response time: DISPLAY: within {allowed}.000 ms | {observed}"
    assert told(check_answers(link, DISPLAY)) == [line]
    assert list(check_answers(link, GATEWAY)) == list(check_answers(link, DOME)) == []
