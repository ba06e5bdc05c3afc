"""Wrong frames: what is sent to which board, what its answer should be, and where silence is right."""

import can
import pytest

from bus.conformance import Board
from bus.conformance.misuse import check_misuse, check_states, check_unknown_identifier, declared_misuse
from bus.protocol import Device, Opcode
from bus.protocol.nodes import DEVICES
from tests.conformance.scripted import (
    AXIS,
    DISPLAY,
    FOCUS,
    GATEWAY,
    OK,
    REFUSED,
    Coming,
    ScriptedBus,
    board,
    declared,
    frame,
    link_on,
    told,
    wrong,
)

DOME = declared("DOME", DEVICES)


def test_a_board_is_sent_what_is_no_command_of_it() -> None:
    bus = ScriptedBus(board(0x51))
    lines = told(check_misuse(link_on(bus), DISPLAY))
    assert bus.lines() == [
        "0d1: ", "0d1: 51", "0d1: 51 01", "0d1: 51 01 00 00 00 00 00", "0d1: 11 01 00 00 00 00 00 00",
        "0d1: 51 7e 00 00 00 00 00 00", "0d1: 51 fe 00 00 00 00 00 00", "0d1: 51 02 c8 00 00 00 00 00",
        "0d1: 51 03 c8 00 00 00 00 00", "0d1: 51 30 65 00 00 00 00 00",
    ]  # fmt: skip
    assert lines == [
        *(f"error wrong length: DISPLAY PING of {length} bytes: one reply: WRONG_LENGTH | OK"
          for length in (0, 1, 2, 7)),
        "error wrong device type: DISPLAY PING for AXIS_RA: one reply: WRONG_DEVICE_TYPE | OK",
        "error unknown opcode: DISPLAY opcode 0x7e: one reply: UNKNOWN_OPCODE | OK",
        "error unknown opcode: DISPLAY opcode 0xfe: one reply: UNKNOWN_OPCODE | OK",
        "error out of range: DISPLAY GET_PARAMETER 200: one reply: OUT_OF_RANGE of parameter 200 "
        "| OK of parameter 0",
        "error out of range: DISPLAY SET_PARAMETER 200 0: one reply: OUT_OF_RANGE of parameter 200 "
        "| OK of parameter 0",
        "error out of range: DISPLAY BRIGHTNESS 101: one reply: OUT_OF_RANGE | OK",
    ]  # fmt: skip


def test_the_other_board_is_never_the_one_that_is_checked() -> None:
    bus = ScriptedBus(board(0x11))
    subjects = [each.subject for each in check_misuse(link_on(bus), AXIS)]
    assert subjects[4] == "AXIS_RA PING for AXIS_DEC" and bus.lines()[4] == "091: 12 01 00 00 00 00 00 00"
    assert subjects[7:] == [
        "AXIS_RA GET_PARAMETER 200", "AXIS_RA SET_PARAMETER 200 0", "AXIS_RA SET_PARAMETER 1 99",
        "AXIS_RA POWER 2", "AXIS_RA SET_CLASS 9 1", "AXIS_RA SET_CLASS 1 5", "AXIS_RA SET_RATE 2147483647",
        "AXIS_RA TRACK_RATE -2147483648", "AXIS_RA OPEN_LOOP 3001", "AXIS_RA MOVE_TO 4294967295 1",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("device", "expected"),
    [
        (
            DOME.model,
            ["SET_PARAMETER 1 9", "SET_PARAMETER 1 1001", "SET_PARAMETER 2 -1", "SET_PARAMETER 2 2",
             "DOME_GOTO 36000", "DOME_SHUTTER 2"],
        ),
        (
            declared("POWER_ROOM", DEVICES).model,
            ["SET_PARAMETER 1 -1", "SET_PARAMETER 1 30001", "SET_PARAMETER 2 -1", "SET_PARAMETER 2 60001",
             "RELAY 0 1", "RELAY 9 1", "RELAY 8 2"],
        ),
        (Device.GATEWAY, []),
    ],
)  # fmt: skip
def test_a_declared_board_is_asked_beyond_each_limit_that_its_bytes_can_pass(
    device: Device, expected: list[str]
) -> None:
    assert [" ".join((o.name, *map(str, values))) for o, values in declared_misuse(device)] == expected


PING = "51 01 00 00 00 00 00 00"
STRANGE = [
    ("unknown identifier", "identifier 0x07f", f"07f: {PING}"),
    ("unknown identifier", "identifier 0x0ff", f"0ff: {PING}"),
    ("unknown identifier", "identifier 0x6aa", f"6aa: {PING}"),
    ("unknown identifier", "identifier 0x7fe", f"7fe: {PING}"),
    ("extended frame", "extended 0x0d1", f"0d1x: {PING}"),
    ("extended frame", "extended 0x03440000", f"3440000x: {PING}"),
    ("remote frame", "remote 0x0d1", "0d1r: dlc 8"),
    ("remote frame", "extended remote 0x03440000", "3440000xr: dlc 8"),
    ("remote frame", "remote 0x151", "151r: dlc 8"),
]


def test_what_is_for_nobody_is_not_answered() -> None:
    bus = ScriptedBus(board(0x51))
    results = list(check_unknown_identifier(link_on(bus, quiet_s=0.25), DISPLAY))
    assert told(results) == [
        *(f"ok {check}: DISPLAY, {subject}: no reply | no reply" for check, subject, _ in STRANGE),
        "ok still there: DISPLAY: one reply: OK | OK",
    ]
    assert bus.lines() == [*(sent for _, _, sent in STRANGE), f"0d1: {PING}"]
    assert [each.duration_s for each in results] == [0.75] * 9 + [0.25]


def test_whatever_is_answered_is_told() -> None:
    def all_of_it(_message: can.Message) -> Coming:
        return [(0.25, frame(0x151, bytes(8)))]

    lines = wrong(check_unknown_identifier(link_on(ScriptedBus(all_of_it), quiet_s=0.25), DISPLAY))
    assert lines[:9] == [
        f"error {check}: DISPLAY, {subject}: no reply | a reply" for check, subject, _ in STRANGE
    ]


@pytest.mark.parametrize(
    ("checked", "motion", "sent", "subjects"),
    [
        (AXIS, False, ["POWER", "SET_RATE", "SET_CLASS", "TRACK_RATE", "OPEN_LOOP", "NUDGE"],
         [f"AXIS_RA {name} after POWER" for name in ("SET_RATE", "SET_CLASS", "TRACK_RATE", "OPEN_LOOP",
                                                     "NUDGE")]),
        (FOCUS, True, ["FOCUS_FREE", "FOCUS_STEP", "FOCUS_REFERENCE", "FOCUS_HOLD"],
         ["FOCUS FOCUS_STEP after FOCUS_FREE", "FOCUS FOCUS_REFERENCE after FOCUS_FREE"]),
        (FOCUS, False, [], []),
        (DISPLAY, True, [], []),
        (GATEWAY, True, [], []),
    ],
)  # fmt: skip
def test_what_cannot_be_carried_out_now_is_refused(
    checked: Board, motion: bool, sent: list[str], subjects: list[str]
) -> None:
    for verdict, level, said in ((REFUSED, "ok", "NOT_ALLOWED"), (OK, "error", "OK")):
        bus = ScriptedBus(board(checked.device, lambda _, verdict=verdict: (verdict, 0, 0)))  # type: ignore[misc]
        lines = told(check_states(link_on(bus, motion=motion), checked))
        assert lines == [f"{level} wrong state: {each}: one reply: NOT_ALLOWED | {said}" for each in subjects]
        assert [Opcode(each.data[1]).name for each in bus.sent] == sent
        assert all(not any(each.data[2:]) for each in bus.sent if each.data[1] != Opcode.SET_CLASS)
