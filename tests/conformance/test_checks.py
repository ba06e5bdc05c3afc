"""The checks themselves: a sound display passes, and each way of being wrong is found by the check that
should."""

import json
from collections.abc import Callable
from pathlib import Path

import can
import pytest

from bus import protocol as p
from bus.can import Frame, Wire
from bus.conformance import Level, Settings, run
from bus.conformance.cli import check, conformance_command
from bus.external import SpecError, open_bus
from bus.pythoncan import SchmidtBus
from bus.time import EventQueue

DISPLAY = p.Device.DISPLAY
SECOND_NS = 1_000_000_000
Change = Callable[["FakeDisplay"], None]


class FakeDisplay:
    """A display of a few lines that keeps the protocol, with one place for every way not to."""

    def __init__(self, wire: Wire) -> None:
        self.wire = wire
        self.port = wire.attach("display")
        self.port.accept([(0x7FF, p.COMMAND_BASE + DISPLAY)])
        self.port.on_receive = self.take
        self.period_ns = SECOND_NS
        self.identifier = p.HEARTBEAT_BASE + DISPLAY
        self.beat = p.pack_heartbeat(DISPLAY, p.State.READY, 0, 0, 0)
        self.answers = 1
        self.health = 0
        self.device = int(DISPLAY)
        self.replace: dict[int, int] = {}
        self.heeds_remote = False
        wire.queue.at(10_000_000, self.tick)

    def tick(self, t_ns: int) -> None:
        self.port.send(Frame(self.identifier, self.beat), t_ns)
        self.wire.queue.at(t_ns + self.period_ns, self.tick)

    def take(self, t_ns: int, frame: Frame) -> None:
        if frame.extended or (frame.remote and not self.heeds_remote):
            return
        opcode, result, value = self.result(frame.data)
        result = self.replace.get(result, result)
        for _ in range(self.answers):
            reply = p.pack_reply(self.device, opcode, result, 0, value)
            self.port.send(Frame(p.REPLY_BASE + DISPLAY, reply), t_ns)

    def result(self, data: bytes) -> tuple[int, int, int]:
        opcode = data[1] if len(data) > 1 else 0
        if len(data) != 8:
            return opcode, p.Result.WRONG_LENGTH, 0
        if data[0] != DISPLAY:
            return opcode, p.Result.WRONG_DEVICE_TYPE, 0
        if opcode not in p.opcodes(DISPLAY):
            return opcode, p.Result.UNKNOWN_OPCODE, 0
        if opcode == p.Opcode.PING:
            return opcode, p.Result.OK, self.health
        if opcode != p.Opcode.BRIGHTNESS or data[2] > 100:
            return opcode, p.Result.OUT_OF_RANGE, 0
        return opcode, p.Result.OK, 0


def failures(change: Change) -> set[tuple[str, Level]]:
    wire = Wire(EventQueue())
    fake = FakeDisplay(wire)
    change(fake)
    with SchmidtBus(wire) as bus:
        results = run(bus, devices=(DISPLAY,), settings=Settings(motion=True))
    return {(result.check, result.level) for result in results if not result.passed}


def test_a_sound_board_passes() -> None:
    assert failures(lambda _: None) == set()


def changed(**values: object) -> Change:
    def change(fake: FakeDisplay) -> None:
        for name, value in values.items():
            setattr(fake, name, value)

    return change


SOUND = p.pack_heartbeat(DISPLAY, p.State.READY, 0, 0, 0)
WRONG: list[tuple[str, Change, set[str]]] = [
    ("another identifier", changed(identifier=0x7A0), {"identifier", "undocumented"}),
    ("seven bytes", changed(beat=SOUND[:7]), {"length"}),
    ("another device type", changed(beat=b"\x52" + SOUND[1:]), {"device type", "contents"}),
    ("a state that is none", changed(beat=SOUND[:2] + b"\x09" + SOUND[3:]), {"contents"}),
    ("three percent slow", changed(period_ns=SECOND_NS * 103 // 100), {"period"}),
    ("not healthy", changed(health=4), {"health"}),
    ("off", lambda fake: setattr(fake.port, "online", False), {"answers", "identifier"}),
    ("deaf", lambda fake: fake.port.accept([]), {"answers"}),
    (
        "answers twice",
        changed(answers=2),
        {"command", "wrong length", "wrong device type", "unknown opcode", "out of range", "still there"},
    ),
    ("forgives wrong length", changed(replace={p.Result.WRONG_LENGTH: 0}), {"wrong length"}),
    ("forgives wrong type", changed(replace={p.Result.WRONG_DEVICE_TYPE: 0}), {"wrong device type"}),
    ("forgives unknown opcodes", changed(replace={p.Result.UNKNOWN_OPCODE: 0}), {"unknown opcode"}),
    ("forgives what is out of range", changed(replace={p.Result.OUT_OF_RANGE: 0}), {"out of range"}),
    ("answers remote frames", changed(heeds_remote=True), {"unknown identifier"}),
]


@pytest.mark.parametrize(("what", "change", "found"), WRONG, ids=[each[0] for each in WRONG])
def test_what_is_wrong_is_found(what: str, change: Change, found: set[str]) -> None:
    assert {name for name, _ in failures(change)} == found


def test_health_is_advice_not_law(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wire = Wire(EventQueue())
    FakeDisplay(wire).health = 1
    path = tmp_path / "found.json"
    # Ten boards of the protocol are missing here, so the verdict is against it, with one line for each.
    with SchmidtBus(wire) as bus:
        assert check(bus, path, Settings()) == 1
    found = json.loads(path.read_text())
    assert found["format"] == "schmidt-conformance 1"
    assert found["failed_should"] == 1
    assert not found["passed"]
    assert "AXIS_RA PING" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("spec", "complaint"),
    [
        ("vcan0", "expected INTERFACE:CHANNEL"),
        ("socketcan:", "expected INTERFACE:CHANNEL"),
        ("sokcetcan:vcan0", 'no interface "sokcetcan"'),
        ("virtual:a,bitrate", '"bitrate" is not key=value'),
    ],
)
def test_a_bus_that_cannot_be_opened_is_one_line(spec: str, complaint: str) -> None:
    with pytest.raises(SpecError, match=complaint):
        conformance_command(spec)


def test_options_reach_the_interface() -> None:
    with open_bus("virtual:test-options,receive_own_messages=1") as bus:
        bus.send(can.Message(arbitration_id=5))
        assert bus.recv(timeout=1) is not None
