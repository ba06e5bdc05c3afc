"""Sending and waiting: what counts as the answer, for how long, and what came in its place."""

from time import monotonic

import can
import pytest

from bus.can import Wire
from bus.conformance import Settings
from bus.conformance.link import Answers, Link, clock_of
from bus.outside.pythoncan import SchmidtBus
from bus.protocol import Opcode, Reply
from bus.time import EventQueue
from tests.conformance.scripted import OK, ScriptedBus, board, frame, line, link_on, reply

DEVICE = 0x51
PING = Reply(DEVICE, Opcode.PING, OK, 0, 0)


def instead(message: can.Message, *known: int) -> str:
    """Kept of a frame that comes as the answer to a PING."""
    bus = ScriptedBus(lambda _: [(0.25, message)])
    link = link_on(bus)
    link.known = set(known)
    answers = link.ask(DEVICE, Opcode.PING)
    assert answers == []
    return answers.instead


def test_the_clock_is_the_wires_or_the_walls() -> None:
    with SchmidtBus(Wire(EventQueue())) as bus:
        bus.recv(1.5)
        assert clock_of(bus)() == pytest.approx(1.5, rel=1e-12)
    assert Link(ScriptedBus(), Settings()).now is clock_of(ScriptedBus()) is monotonic


def test_a_machine_that_cannot_tell_has_lost_nothing() -> None:
    assert link_on(ScriptedBus()).lost == 0


def test_listening_ends_in_time_and_hears_no_error_frames() -> None:
    bus = ScriptedBus()
    link = link_on(bus)
    every = [frame(5), frame(6, is_error_frame=True), frame(7, is_remote_frame=True), frame(8), frame(9)]
    for at_s, message in zip((0.0, 0.25, 0.5, 1.0, 1.5), every, strict=True):
        bus.hear(at_s, message)
    assert link.listen(0.0) == []
    assert link.listen(1.0) == [every[0], every[2], every[3]]
    assert bus.now_s == 1.0
    assert link.listen(0.25) == [] and bus.now_s == 1.25


def test_a_frame_is_the_next_data_frame_with_its_standard_identifier() -> None:
    bus = ScriptedBus()
    link = link_on(bus)
    wanted = frame(5, b"\x01")
    others = (
        can.Message(arbitration_id=5, is_extended_id=True), frame(5, is_remote_frame=True), frame(6),
    )  # fmt: skip
    for message in (*others, wanted, frame(5, b"\x02")):
        bus.hear(0.5, message)
    assert link.frame(5, 1.0) is wanted and bus.now_s == 0.5
    assert link.frame(6, 0.25) is None and bus.now_s == 0.75


@pytest.mark.parametrize(
    ("kind", "sent"),
    [
        ({}, "123: 01 02"),
        ({"extended": True}, "123x: 01 02"),
        ({"remote": True}, "123r: dlc 2"),
        ({"extended": True, "remote": True}, "123xr: dlc 2"),
    ],
)
def test_a_frame_is_sent_as_asked(kind: dict[str, bool], sent: str) -> None:
    bus = ScriptedBus()
    link_on(bus).send(0x123, b"\x01\x02", **kind)
    assert [line(message) for message in bus.sent] == [sent]


@pytest.mark.parametrize(
    ("message", "known", "said"),
    [
        (frame(0x191, bytes(8)), (), "answered with 0x191 instead of 0x151"),
        (frame(0x117, bytes(8)), (0x117,), "answered with 0x117 instead of 0x151"),
        (frame(0x17F, bytes(8)), (0x17F,), "answered with 0x17f instead of 0x151"),
        (frame(0x251, bytes(8)), (), "answered with 0x251 instead of 0x151"),
        (frame(0x251, bytes(8)), (0x251,), ""),
        (frame(0x0D1, bytes(8)), (), ""),
        (frame(0x080, bytes(8)), (), ""),
        (frame(0x07F, bytes(8)), (), "answered with 0x07f instead of 0x151"),
        (frame(0x151, bytes(7)), (), "answered with 7 bytes instead of 8"),
        (frame(0x151, is_remote_frame=True, dlc=8), (), "answered with 0 bytes instead of 8"),
        (reply(DEVICE, Opcode.STOP), (), "answered for opcode 0x11 instead of 0x01"),
    ],
    ids=lambda value: line(value) if isinstance(value, can.Message) else "",
)
def test_what_came_instead_is_told(message: can.Message, known: tuple[int, ...], said: str) -> None:
    assert instead(message, *known) == said


@pytest.mark.parametrize("identifier", [0x151, 0x0D1, 0x251])
def test_an_extended_frame_is_never_the_answer(identifier: int) -> None:
    message = can.Message(arbitration_id=identifier, data=bytes(8), is_extended_id=True)
    assert instead(message, identifier) == f"answered with extended {identifier:#05x} instead of 0x151"


def test_each_that_came_instead_is_told_once_and_only_of_the_last_command() -> None:
    strays = [(0.25, frame(0x191)), (0.5, frame(0x192)), (0.5, frame(0x191))]
    bus = ScriptedBus(lambda message: strays if message.data[1] == Opcode.PING else ())
    link = link_on(bus)
    said = "answered with 0x191 instead of 0x151, answered with 0x192 instead of 0x151"
    assert link.ask(DEVICE, Opcode.PING).instead == said
    assert link.ask(DEVICE, Opcode.STOP).instead == Answers.instead == ""


@pytest.mark.parametrize(
    ("after_s", "count", "end_s"),
    [
        ((0.5,), 1, 0.75),
        ((1.0,), 1, 1.25),
        ((1.25,), 0, 1.0),
        ((0.5, 0.75), 2, 1.0),
        ((0.5, 0.875), 1, 0.75),
        ((0.5, 0.625, 0.75), 3, 1.0),
    ],
)
def test_the_first_answer_has_its_time_and_any_further_one_less(
    after_s: tuple[float, ...], count: int, end_s: float
) -> None:
    bus = ScriptedBus(lambda _: [(each, reply(DEVICE, Opcode.PING)) for each in after_s])
    link = link_on(bus, reply_s=1.0, quiet_s=0.25)
    assert link.ask(DEVICE, Opcode.PING) == [PING] * count
    assert bus.now_s == end_s
    assert link.took_s == ({DEVICE: [(after_s[0], Opcode.PING)]} if count else {})


def test_times_are_kept_by_device_and_counted_from_the_command() -> None:
    bus = ScriptedBus(lambda message: board(message.arbitration_id - 0x080, after_s=0.25)(message))
    link = link_on(bus, quiet_s=0.5)
    link.ask(DEVICE, Opcode.PING)
    link.ask(0x11, Opcode.STOP)
    link.first(DEVICE, Opcode.BRIGHTNESS, 1)
    assert link.took_s == {
        DEVICE: [(0.25, Opcode.PING), (pytest.approx(0.25), Opcode.BRIGHTNESS)], 0x11: [(0.25, Opcode.STOP)],
    }  # fmt: skip


def test_the_first_answer_leaves_the_bus_to_others() -> None:
    coming = [(0.25, reply(DEVICE, Opcode.STOP)), (0.5, reply(DEVICE, Opcode.PING, OK, 0, 3))]
    bus = ScriptedBus(lambda _: coming)
    link = link_on(bus, reply_s=0.5)
    assert link.first(DEVICE, Opcode.PING) == Reply(DEVICE, Opcode.PING, OK, 0, 3)
    assert bus.now_s == 0.5 + 0.0005  # half a millisecond more
    coming = [(0.75, reply(DEVICE, Opcode.PING))]
    assert link.first(DEVICE, Opcode.PING) is None
    assert link.took_s == {DEVICE: [(0.5, Opcode.PING)]}


@pytest.mark.parametrize(
    ("message", "after_s", "silent"),
    [
        (frame(0x151, b"\x01"), 0.75, False),
        (frame(0x151, b"\x01"), 0.875, True),
        (frame(0x151, is_remote_frame=True), 0.25, True),
        (frame(0x152, b"\x01"), 0.25, True),
    ],
)
def test_silence_is_no_frame_of_the_kind_for_three_times_the_quiet(
    message: can.Message, after_s: float, silent: bool
) -> None:
    bus = ScriptedBus()
    bus.hear(after_s, message)
    assert link_on(bus, quiet_s=0.25).silent(DEVICE) is silent


@pytest.mark.parametrize(
    ("data", "opcode", "parameter"),
    [
        (b"\x51\x02\x07\0\0\0\0\0", 2, 7),
        (b"\x51\x03\x09\0\0\0\0\0", 3, 9),
        (b"\x51\x01\x07\0\0\0\0\0", 1, None),
        (b"\x52\x02\x07\0\0\0\0\0", 2, None),
        (b"\x51\x02\x07\0\0\0\0", 2, None),
        (b"\x51\x02", 2, None),
        (b"\x51", 0, None),
        (b"", 0, None),
    ],
    ids=str,
)
def test_any_bytes_are_asked_and_a_named_parameter_is_kept(
    data: bytes, opcode: int, parameter: int | None
) -> None:
    bus = ScriptedBus(board(DEVICE))
    answers = link_on(bus).ask_raw(DEVICE, data)
    assert bus.lines() == [f"0d1: {data.hex(' ')}"]
    assert answers == [Reply(DEVICE, opcode, OK, 0, 0)]
    assert answers.parameter == parameter
