"""Frames that receivers lose, noise on EnDat and RS232 lines, a PWM that keeps its duties: by themselves."""

from types import SimpleNamespace
from typing import Any

import pytest

from bus.can import Frame
from bus.protocol import COMMAND_BASE, REPLY_BASE
from scenarios.lab.faults.onchip import EndatLine, FrameLoss, PwmStuck, SerialNoise
from scenarios.lab.layers import Staged
from tests.scenarios.lab.faults.stub import acted, place


@pytest.mark.parametrize(
    ("given", "identifier", "missed"),
    [({"identifier": 0x211}, 0x211, True), ({"identifier": 0x211}, 0x212, False),
     ({"identifier": 0}, 0, True),
     ({"node": "B"}, 0x212, True), ({"node": "B"}, 0x211, False), ({"node": "B"}, COMMAND_BASE + 0x12, False),
     ({"node": "B"}, REPLY_BASE + 0x12, True), ({}, 0x211, False)],
)  # fmt: skip
def test_frames_of_an_identifier_or_of_a_board_are_lost(
    given: dict[str, Any], identifier: int, missed: bool
) -> None:
    """Device types are 0x11 and 0x12; commands to a board are not its own frames."""
    where, heard = place(), list[Frame]()
    port: Any = where.board("A").port
    port.on_receive = lambda t_ns, frame: heard.append(frame)
    loss = FrameLoss(where, {"probability": 1.0, **given}, 0)
    port.on_receive(1, Frame(identifier, b""))
    assert (not heard) is missed
    assert where.board("B").port.on_receive is None  # who does not listen loses nothing
    loss.clear(2)
    port.on_receive(3, Frame(identifier, b""))
    assert len(heard) == 1 + (not missed)


def test_each_receiver_loses_its_share() -> None:
    where, heard = place(), list[Frame]()
    port: Any = where.board("A").port
    port.on_receive = lambda t_ns, frame: heard.append(frame)
    FrameLoss(where, {"probability": 0.2, "identifier": 5}, 0)
    for _ in range(2000):
        port.on_receive(1, Frame(5, b""))
    assert len(heard) == pytest.approx(1600, abs=80)


@pytest.mark.parametrize("line", [None, lambda frame: frame ^ 1])
def test_a_transfer_has_one_of_36_bits_inverted(line: Any) -> None:
    where = place("POSITION_RA")
    board = where.board("POSITION_RA")
    board.endat = SimpleNamespace(line=line)
    where.network.queue.now_ns = 8
    EndatLine(where, {"axis": "ra", "probability": 1.0}, 0)
    base = 0 if line is None else 1
    flips = {board.endat.line(0) ^ base for _ in range(1500)}
    assert flips == {1 << bit for bit in range(36)}
    assert acted(where.evidence) == (8, "transfer of POSITION_RA")


def test_a_share_of_nothing_changes_no_transfer_and_no_packet() -> None:
    where = place("POSITION_RA")
    where.board("POSITION_RA").endat = SimpleNamespace(line=None)
    EndatLine(where, {"axis": "ra", "probability": 0.0}, 0)
    assert where.board("POSITION_RA").endat.line(5) == 5 and where.evidence.first_ns is None


def test_a_packet_has_one_of_its_bits_inverted() -> None:
    where, heard = place(), list[bytes]()
    uart: Any = SimpleNamespace(sink=lambda t_ns, packet: heard.append(packet))
    where.network.uarts["A"] = uart
    noise = SerialNoise(where, {"node": "A", "probability": 1.0}, 0)
    for _ in range(600):
        uart.sink(3, b"\0\0\0")
    assert {int.from_bytes(each, "little") for each in heard} == {1 << bit for bit in range(24)}
    assert acted(where.evidence) == (3, "RS232 packet of A")
    noise.clear(4)
    uart.sink(5, b"\0")
    assert heard[-1] == b"\0"


def test_a_line_that_nobody_listens_to_has_no_noise_and_a_board_without_one_is_said() -> None:
    where = place()
    uart: Any = SimpleNamespace(sink=None)
    where.network.uarts["A"] = uart
    SerialNoise(where, {"node": "A", "probability": 1.0}, 0)
    uart.sink(1, b"\0")
    assert where.evidence.first_ns is None
    with pytest.raises(ValueError, match=r"^serial_noise: node: no RS232; use one of A$"):
        SerialNoise(where, {"node": "B", "probability": 1.0}, 0)


def test_a_stuck_PWM_keeps_the_duties_of_the_beginning(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Staged, "__init__", lambda *_: None)
    stuck = PwmStuck(place(), {"axis": "ra"}, 0)
    assert stuck.duties((0.0, 0.1)) == (0.0, 0.1)
    assert stuck.duties((0.5, 0.2)) == (0.0, 0.1)
