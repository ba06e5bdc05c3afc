"""The link and the client, against boards that are a few lines of test code."""

from collections.abc import Callable
from pathlib import Path

import pytest

from bus.can.frame import Frame
from bus.protocol import (
    HEARTBEAT_BASE,
    MEASUREMENT_BASE,
    REPLY_BASE,
    Device,
    Opcode,
    Result,
    pack_heartbeat,
    pack_motion,
    pack_reply,
)
from bus.protocol.report import pack_report, slot, unpack_commands
from bus.protocol.serial import AxisSample, Packet, pack_packet
from host.client import REPLY_TIMEOUT_NS, TICK_NS, TRIES, Client, ClientError, Procedure
from host.link import HidLink
from host.logs.files import LogError
from host.logs.journal import AsciiLogs
from host.procedures.manual import health_check
from host.serial_link import SerialLink

Answer = Callable[[int, Frame], list[Frame]]


class Desk:
    """A client whose commands go to `answer`, which returns the frames that come back."""

    def __init__(self, folder: Path, answer: Answer, devices: tuple[Device, ...] = (Device.AXIS_RA,)) -> None:
        self.logs = AsciiLogs(folder, lambda t: f"{t:.3f}")
        self.sent: list[Frame] = []
        self.link = HidLink(self._send)
        self.client = Client(self.link, self.logs, devices)
        self._answer = answer
        self.t_ns = 0

    def _send(self, t_ns: int, report: bytes) -> None:
        for frame in unpack_commands(report):
            self.sent.append(frame)
            for back in self._answer(t_ns, frame):
                self.link.receive(t_ns, pack_report([slot(back)]))

    def run(self, procedure: Procedure, ticks: int = 1000) -> object:
        for _ in range(ticks):
            self.t_ns += TICK_NS
            try:
                next(procedure)
            except StopIteration as end:
                return end.value
            self.client.tick(self.t_ns)
        raise AssertionError("the procedure does not end")


def ok(_t_ns: int, frame: Frame) -> list[Frame]:
    device, opcode = frame.data[0], frame.data[1]
    return [Frame(REPLY_BASE + device, pack_reply(device, opcode, Result.OK, 0, 0))]


def silent(_t_ns: int, _frame: Frame) -> list[Frame]:
    return []


def test_H1_a_command_is_eight_bytes_to_the_device_and_its_reply_comes_back(tmp_path: Path) -> None:
    desk = Desk(tmp_path, ok)
    reply = desk.run(desk.client.ask(Device.AXIS_RA, Opcode.POWER, 1))
    assert desk.sent == [Frame(0x091, bytes([0x11, 0x10, 1, 0, 0, 0, 0, 0]))]
    assert reply is not None
    desk.logs.flush()
    assert "AXIS_RA  POWER 1  ok 0" in (tmp_path / "commands.log").read_text()


def test_a_silent_board_is_tried_three_times_and_named(tmp_path: Path) -> None:
    desk = Desk(tmp_path, silent)
    with pytest.raises(ClientError, match="AXIS_RA: STOP: no answer after 3 tries"):
        desk.run(desk.client.ask(Device.AXIS_RA, Opcode.STOP))
    assert len(desk.sent) == TRIES
    assert TRIES * REPLY_TIMEOUT_NS <= desk.t_ns <= TRIES * REPLY_TIMEOUT_NS + 4 * TICK_NS


def test_a_lost_reply_is_asked_for_again(tmp_path: Path) -> None:
    heard: list[Frame] = []

    def second_time(t_ns: int, frame: Frame) -> list[Frame]:
        heard.append(frame)
        return ok(t_ns, frame) if len(heard) == 2 else []

    desk = Desk(tmp_path, second_time)
    desk.run(desk.client.ask(Device.AXIS_RA, Opcode.STOP))
    assert len(heard) == 2
    assert desk.logs.error_entries == 1


def test_an_answer_that_comes_twice_answers_nobody_who_has_not_been_sent(tmp_path: Path) -> None:
    desk = Desk(tmp_path, lambda t_ns, frame: 2 * ok(t_ns, frame))
    first, second = (desk.client.ask(Device.AXIS_RA, Opcode.GET_PARAMETER, number) for number in (1, 2))
    next(first)
    next(second)
    desk.run(first)
    desk.run(second)
    assert [frame.data[2] for frame in desk.sent] == [1, 2]


def test_a_stop_passes_what_moves_nothing_and_stays_behind_what_moves(tmp_path: Path) -> None:
    desk = Desk(tmp_path, silent)
    ask = desk.client.ask
    for opcode, values in ((Opcode.SET_RATE, (7,)), (Opcode.GET_PARAMETER, (1,)), (Opcode.PING, ())):
        next(ask(Device.AXIS_RA, opcode, *values))
    stop = ask(Device.AXIS_RA, Opcode.STOP)
    with pytest.raises(ClientError, match="no answer"):
        desk.run(stop)
    sent = [frame.data[1] for frame in desk.sent]
    assert sent[:6] == [Opcode.SET_RATE] * 3 + [Opcode.STOP] * 3


def test_a_refusal_names_device_command_and_reason(tmp_path: Path) -> None:
    def refuse(_t_ns: int, frame: Frame) -> list[Frame]:
        device, opcode = frame.data[0], frame.data[1]
        return [Frame(REPLY_BASE + device, pack_reply(device, opcode, Result.OUT_OF_RANGE, 0, 0))]

    desk = Desk(tmp_path, refuse)
    with pytest.raises(ClientError, match="AXIS_RA: MOVE_TO 5 1 was refused: out of range"):
        desk.run(desk.client.ask(Device.AXIS_RA, Opcode.MOVE_TO, 5, 1))


def test_H2_health_check_names_the_board_that_is_ill(tmp_path: Path) -> None:
    def stale(_t_ns: int, frame: Frame) -> list[Frame]:
        device, opcode = frame.data[0], frame.data[1]
        value = 2 if device == Device.DISPLAY else 0
        return [Frame(REPLY_BASE + device, pack_reply(device, opcode, Result.OK, 0, value))]

    desk = Desk(tmp_path, stale, (Device.AXIS_RA, Device.DISPLAY))
    with pytest.raises(ClientError, match="DISPLAY reports stale"):
        desk.run(health_check(desk.client))


def test_measurements_are_kept_per_device(tmp_path: Path) -> None:
    desk = Desk(tmp_path, ok)
    frame = Frame(MEASUREMENT_BASE + Device.AXIS_RA, pack_motion(Device.AXIS_RA, 0x81, -7, 100, (3, 4)))
    for t_ns in (5, 15):
        desk.link.receive(t_ns, pack_report([slot(frame)] * 3))
    motion = desk.client.motion(Device.AXIS_RA)
    assert motion is not None
    assert (motion.velocity, motion.effort) == (-7, 100)
    assert desk.link.measured_ns == {Device.AXIS_RA: 15}
    desk.link.receive(20, b"short")
    assert desk.link.bad_reports == 1


def test_a_board_without_heartbeat_is_reported_once_and_welcomed_back(tmp_path: Path) -> None:
    desk = Desk(tmp_path, ok)
    desk.run(desk.client.ask(Device.AXIS_RA, Opcode.PING))
    assert desk.client.health == {Device.AXIS_RA: 0}
    for t_s in range(1, 8):
        desk.client.tick(t_s * 10**9)
    assert desk.logs.error_entries == 1
    assert not desk.client.health  # who comes back may be another
    beat = Frame(HEARTBEAT_BASE + Device.AXIS_RA, pack_heartbeat(Device.AXIS_RA, 1, 3, 0, 0))
    desk.link.receive(8 * 10**9, pack_report([slot(beat)]))
    desk.client.tick(8 * 10**9)
    desk.logs.flush()
    assert "is back" in (tmp_path / "status.log").read_text()


def test_a_condition_that_never_comes_is_named(tmp_path: Path) -> None:
    desk = Desk(tmp_path, ok)
    with pytest.raises(ClientError, match="FOCUS: at 5: not within 1 s"):
        desk.run(desk.client.until("FOCUS: at 5", lambda: False, 1.0))


SAMPLES = [AxisSample(1, 2, 3, 4, 5, 6, 7, 8, 9)] * 25


def test_H1_a_broken_link_stops_only_itself(tmp_path: Path) -> None:
    logs = AsciiLogs(tmp_path, str)
    got: list[Packet] = []

    def break_down(_t_ns: int, _packet: Packet) -> None:
        raise RuntimeError("boom")

    broken = SerialLink(Device.AXIS_RA, logs, break_down)
    healthy = SerialLink(Device.AXIS_RA, logs, lambda _t, packet: got.append(packet))
    for sequence in range(3):
        data = pack_packet(Device.AXIS_RA, sequence, sequence * 2500, SAMPLES)
        broken.receive(sequence, data)
        healthy.receive(sequence, data)
    assert broken.broken
    assert len(got) == 3
    assert logs.error_entries == 1


def test_L3_missing_packets_and_wrong_crcs_are_logged(tmp_path: Path) -> None:
    logs = AsciiLogs(tmp_path, str)
    link = SerialLink(Device.AXIS_RA, logs, lambda _t, _p: None)
    for sequence in (0, 1, 4):
        link.receive(0, pack_packet(Device.AXIS_RA, sequence, 0, SAMPLES))
    assert (link.packets, link.lost) == (3, 2)
    spoiled = bytearray(pack_packet(Device.AXIS_RA, 5, 0, SAMPLES))
    spoiled[40] ^= 1
    link.receive(0, bytes(spoiled))
    assert link.packets == 3
    assert logs.error_entries == 2
    link.watch(10**10)
    link.watch(2 * 10**10)
    assert logs.error_entries == 3  # the silence, once


def test_a_full_disk_is_not_a_broken_link(tmp_path: Path) -> None:
    def full(_t_ns: int, _packet: Packet) -> None:
        raise LogError("disk: no space left")

    link = SerialLink(Device.AXIS_RA, AsciiLogs(tmp_path, str), full)
    with pytest.raises(LogError):
        link.receive(0, pack_packet(Device.AXIS_RA, 0, 0, SAMPLES))
