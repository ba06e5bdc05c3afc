"""The smallest bench: which boards, when an answer counts, and a command that is refused."""

from types import SimpleNamespace
from typing import Any

import pytest

from bus.can import Frame
from bus.protocol import COMMAND_BASE, REPLY_BASE, Device, Opcode, pack_command
from scenarios.lab import axisbench
from scenarios.lab.axisbench import AxisBench

S = 1_000_000_000


def reply(data: bytes) -> Any:
    """Short, for who knows no layout."""
    return SimpleNamespace(opcode=data[0], result=data[1])


class Desk:
    """A bench on a bus that answers as a test says; sent: (time, frame); ran: until when."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.sent: list[tuple[int, Frame]] = []
        self.ran: list[int] = []
        self.answer: int | None = 0
        self.masks: Any = None
        self.port = SimpleNamespace(send=self.send, accept=self.accept, on_receive=None)
        wire = SimpleNamespace(attach=lambda name: self.port)
        network = SimpleNamespace(wire=wire, run_until=self.ran.append)
        monkeypatch.setattr(axisbench, "Plant", lambda model, seed, starts: (model, seed, starts))
        monkeypatch.setattr(axisbench, "unpack_reply", reply)
        monkeypatch.setattr(axisbench, "build", self.build)
        self.network = network
        model: Any = "model"
        self.bench = AxisBench(model, 7, 5.0)

    def build(self, config: Any, plant: Any, seed: int) -> Any:
        self.built = config.size, plant, seed
        return self.network

    def accept(self, masks: Any) -> None:
        self.masks = masks

    def send(self, frame: Frame, t_ns: int) -> None:
        self.sent.append((t_ns, frame))
        if self.answer is not None:
            hear: Any = self.port.on_receive
            hear(t_ns, Frame(REPLY_BASE + Device.AXIS_RA, bytes([Opcode.POWER, self.answer])))


def test_the_axis_and_its_encoder_are_heard_before_anything_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    desk = Desk(monkeypatch)
    assert desk.built == (2, ("model", 7, {"ra": 5.0}), 7) and desk.ran == [S // 5]
    assert desk.masks == [(0x7FF, REPLY_BASE + Device.AXIS_RA)]
    desk.bench.wait(1.5)
    assert desk.ran[1:] == [S // 5 + 3 * S // 2]


def test_a_command_is_answered_within_twenty_milliseconds(monkeypatch: pytest.MonkeyPatch) -> None:
    desk = Desk(monkeypatch)
    desk.bench.command(Opcode.POWER, 1)
    frame = Frame(COMMAND_BASE + Device.AXIS_RA, pack_command(Device.AXIS_RA, Opcode.POWER, 1))
    assert desk.sent == [(S // 5, frame)] and desk.ran[-1] == S // 5 + S // 50
    desk.answer = 3
    with pytest.raises(ValueError, match=r"^axis board: POWER \(1,\) was refused: 3$"):
        desk.bench.command(Opcode.POWER, 1)
    desk.answer = None  # an answer of before is none
    with pytest.raises(ValueError, match=r"^axis board: POWER \(0,\) was not answered within 20 ms$"):
        desk.bench.command(Opcode.POWER, 0)


def test_an_answer_to_another_command_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    desk = Desk(monkeypatch)
    with pytest.raises(ValueError, match=r"STOP .* was not answered"):
        desk.bench.command(Opcode.STOP)
