"""Frames that boards send unasked: which are judged, by what, and which nobody has documented."""

from collections.abc import Iterator

import can
import pytest

from bus.conformance import Board, parse
from bus.conformance.link import Link
from bus.conformance.telemetry import check_telemetry
from bus.protocol import State, pack_heartbeat
from bus.protocol.database import database
from bus.protocol.nodes import DEVICES, documented
from tests.conformance.scripted import AXIS, DISPLAY, ScriptedBus, declared, frame, link_on, told, wrong

OTHER = parse("display:0x53")


def beat(second: int, device: int = 0x51, state: int = State.READY) -> bytes:
    return pack_heartbeat(device, state, 40 + second, 0, 0)


def speaking(beats: list[bytes], identifier: int = 0x751, speed: float = 1.0) -> ScriptedBus:
    bus = ScriptedBus()
    for second, data in enumerate(beats):
        bus.hear((0.5 + second) / speed, frame(identifier, data))
    return bus


def heard(bus: ScriptedBus, board: Board = DISPLAY, **settings: float) -> list[str]:
    return told(check_telemetry(link_on(bus, **settings), database(), [board]))


@pytest.mark.parametrize(
    ("board", "speed", "stamps_ms", "higher"),
    [(DISPLAY, 1.0, 1, 22), (OTHER, 1.0, 1, 23), (DISPLAY, 2.0, 2, 22)],
)
def test_a_sound_frame_word_by_word(board: Board, speed: float, stamps_ms: int, higher: int) -> None:
    """higher: periodic frames of more priority; they, two more and 0.5 ms of the board may hold it up."""
    device, allowed_ms = board.device, (2 + higher) * 0.135 + 0.5 + stamps_ms
    bus = speaking([beat(second, device) for second in range(4)], 0x700 + device, speed)
    name = f"{board.name}_HEARTBEAT"
    assert heard(bus, board, speed=speed) == [
        f"ok identifier: {name}: frames with 0x7{device:x} | 4 in {4.2 / speed:.2f} s",
        f"ok length: {name}: 8 bytes | [8] bytes",
        f"ok device type: {name}: byte 0 = {device:#x} | {device:#x}",
        f"ok contents: {name}: every signal within its range | 4 frames within",
        f"ok uptime: {name}: 3.00 s more, ± {1 + stamps_ms / 1e3:.3f} s | 3 s more",
        f"ok overruns: {name}: none new | 0 at first, 0 at last",
        f"ok error counter: {name}: TEC up to 96 | TEC 0",
        f"ok state: {name}: no FAULT | none",
        f"ok period: {name}: 1000 ms ± 2.0% | mean 1000.000 ms",
        f"ok jitter: {name}: within {allowed_ms:.3f} ms | 0.000 ms",
        f"ok gap: {name}: at most {1500 + allowed_ms:.3f} ms | 1000.000..1000.000 ms",
        "ok undocumented: bus: no other frames | none",
    ]


def test_the_bus_is_listened_to_once_for_all() -> None:
    bus = ScriptedBus()
    link = link_on(bus, listen_s=2.0, speed=4.0)
    bus.hear(0.25, frame(0x751, beat(0)))
    bus.hear(0.25, frame(0x7A0))
    results = list(check_telemetry(link, database(), [DISPLAY, AXIS]))
    assert bus.now_s == 0.5
    assert link.known == {0x751, 0x7A0}
    times = {each.check: each.duration_s for each in results}
    checks = ("identifier", "length", "device type", "contents", "undocumented")
    assert {check: times[check] for check in checks} == dict.fromkeys(checks, 0.5)
    identifiers = [(each.subject, each.observed) for each in results if each.check == "identifier"]
    assert identifiers == [
        ("DISPLAY_HEARTBEAT", "1 in 0.50 s"), ("AXIS_RA_MOTION", "0 in 0.50 s"),
        ("AXIS_RA_TARGET", "0 in 0.50 s"), ("AXIS_RA_HEARTBEAT", "0 in 0.50 s"),
    ]  # fmt: skip


@pytest.mark.parametrize("count", [0, 1, 2, 3])
def test_two_frames_say_nothing_about_a_period(count: int) -> None:
    lines = heard(speaking([beat(second) for second in range(count)]))
    told_of = [line for line in lines if line.split(":")[0].split()[1] in ("period", "jitter", "gap")]
    if count == 0:
        assert lines[0] == "error identifier: DISPLAY_HEARTBEAT: frames with 0x751 | 0 in 4.20 s"
        assert len(lines) == 2
    elif count < 3:
        said = f"{count} frames in 4.20 s say nothing about a period"
        assert told_of == [f"info period: DISPLAY_HEARTBEAT:  | {said}"]
    else:
        assert len(told_of) == 3 and all(line.startswith("ok") for line in told_of)


STATE = "error contents: {0}: every signal within its range | State = {1}, not 0..3"


@pytest.mark.parametrize(
    ("beats", "lines"),
    [
        ([beat(0), beat(1)[:7]], ["error length: {0}: 8 bytes | [7, 8] bytes"]),
        ([beat(0)[:7]] * 2, ["error length: {0}: 8 bytes | [7] bytes"]),
        ([beat(0, 0x52), beat(1)], ["error device type: {0}: byte 0 = 0x51 | 0x51, 0x52"]),
        ([beat(0, 0x05)], ["error device type: {0}: byte 0 = 0x51 | 0x05"]),
        ([beat(0), b""], ["error length: {0}: 8 bytes | [0, 8] bytes",
                          "error device type: {0}: byte 0 = 0x51 | none, 0x51"]),
        ([beat(0), beat(1, state=4)], [STATE.format("{0}", 4)]),
        ([beat(0, state=9), beat(1)], [STATE.format("{0}", 9)]),
        ([beat(0, state=0), beat(1, state=2)], []),
        ([beat(0), beat(1, state=3)], ["error state: {0}: no FAULT | FAULT"]),
        ([b"\x51\xf6" + beat(0)[2:]],
         ["error contents: {0}: every signal within its range | Kind = 246, not 247..247"]),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_and_nothing_else(beats: list[bytes], lines: list[str]) -> None:
    found = wrong(check_telemetry(link_on(speaking(beats)), database(), [DISPLAY]))
    assert found == [line.format("DISPLAY_HEARTBEAT") for line in lines]


@pytest.mark.parametrize(
    ("board", "message", "said"),
    [
        (DISPLAY, frame(0x7A0), "0x7a0"),
        (DISPLAY, frame(0x07A), "0x07a"),
        (DISPLAY, frame(0x7A0, is_remote_frame=True), "remote 0x7a0"),
        (DISPLAY, frame(0x051, is_remote_frame=True), "remote 0x051"),
        (DISPLAY, can.Message(arbitration_id=0x1234567), "extended 0x1234567"),
        (DISPLAY, can.Message(arbitration_id=5, is_remote_frame=True), "remote 0x005"),
        (DISPLAY, frame(0x151), None),
        (DISPLAY, frame(0x111), None),
        (DISPLAY, frame(0x153), "0x153"),
        (OTHER, frame(0x153), None),
        (OTHER, frame(0x151), None),
    ],
)
def test_frames_that_nobody_has_documented(board: Board, message: can.Message, said: str | None) -> None:
    bus = ScriptedBus()
    bus.hear(1.0, message)
    level = "issue" if said else "ok"
    assert heard(bus, board)[-1] == f"{level} undocumented: bus: no other frames | {said or 'none'}"


def test_undocumented_frames_are_told_in_order() -> None:
    bus = ScriptedBus()
    for message in (frame(0x7B0), frame(0x7A0), frame(5, is_remote_frame=True), frame(0x7A0)):
        bus.hear(1.0, message)
    bus.hear(1.0, can.Message(arbitration_id=7))
    assert heard(bus)[-1].endswith("| extended 0x007, remote 0x005, 0x7a0, 0x7b0")


def test_a_declared_boards_frames_are_its_kinds() -> None:
    dome = declared("DOME", DEVICES)
    lines = told(check_telemetry(link_on(ScriptedBus()), documented([dome.model]), [dome]))
    assert [line.split(": ")[1:] for line in lines[:2]] == [
        ["DOME_DOME", "frames with 0x271 | 0 in 4.20 s"],
        ["DOME_HEARTBEAT", "frames with 0x771 | 0 in 4.20 s"],
    ]


def test_frames_that_the_tester_lost_meanwhile_count(monkeypatch: pytest.MonkeyPatch) -> None:
    numbers: Iterator[int] = iter((3, 5))
    monkeypatch.setattr(Link, "lost", property(lambda _: next(numbers)))
    lines = heard(speaking([beat(0), beat(1), beat(2)]))
    assert [line.partition(" | ")[2] for line in lines if " period:" in line] == [
        "mean 1000.000 ms, 2 frames were lost here"
    ]
