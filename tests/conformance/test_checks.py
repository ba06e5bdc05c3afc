"""The checks themselves: a sound display passes, and each way of being wrong is found by the check that
should."""

import json
from collections.abc import Callable
from pathlib import Path

import can
import pytest

from bus import protocol as p
from bus.can import Frame, Wire
from bus.conformance import CheckResult, Level, Settings, board_of, parse, run
from bus.conformance.cli import check, conformance_command
from bus.conformance.limits import PARAMETERS
from bus.kit import CHECKS
from bus.outside.external import SpecError, open_bus
from bus.outside.pythoncan import SchmidtBus
from bus.time import EventQueue
from tests.conformance.kit import run_kit

DISPLAY = p.Device.DISPLAY
SECOND_NS = 1_000_000_000
Change = Callable[["FakeDisplay"], None]


class FakeDisplay:
    """A display of a few lines that keeps the protocol, with one place for every way not to."""

    device = int(DISPLAY)
    model = DISPLAY
    beats_ns = (SECOND_NS,)
    """Intervals between heartbeats, over and over."""

    def __init__(self, wire: Wire) -> None:
        self.wire = wire
        self.port = wire.attach("fake")
        self.port.accept(None)
        self.port.on_receive = self.take
        self.identifier = p.HEARTBEAT_BASE + self.device
        self.spoil: Callable[[bytes], bytes] = bytes
        """What becomes of a heartbeat on its way."""
        self.state, self.tec = p.State.READY, 0
        self.uptime_steps, self.overruns = 1, 0
        """More in every heartbeat."""
        self.beats = 0
        self.answers = 1
        self.answer_ns = 0
        self.slow: set[int] = set(range(0x100))
        """Opcodes whose answer takes `answer_ns`."""
        self.elsewhere = p.REPLY_BASE + self.device
        self.twisted: dict[int, int] = {}
        """Byte of every answer -> added to it."""
        self.cut = 8
        self.health = 0
        self.says = self.device
        self.replace: dict[int, int] = {}
        self.heeds: set[str] = set()
        self.forgets = 0
        """Every so manieth command of a quick succession."""
        self.darkest, self.brightest = 0, 100
        self.deaf_from = 0
        """The so manieth command of a quick succession is the last it takes."""
        self.quick, self.last_ns = 0, -SECOND_NS
        self.chatter: Frame | None = None
        wire.queue.at(10_000_000, self.tick)

    def tick(self, t_ns: int) -> None:
        up, lost = t_ns // SECOND_NS * self.uptime_steps, self.beats * self.overruns
        beat = p.pack_heartbeat(self.device, self.state, up, lost, self.tec)
        self.port.send(Frame(self.identifier, self.spoil(beat)), t_ns)
        if self.chatter:
            self.port.send(self.chatter, t_ns)
        interval = self.beats_ns[self.beats % len(self.beats_ns)]
        self.beats += 1
        self.wire.queue.at(t_ns + interval, self.tick)

    def meant(self, frame: Frame) -> bool:
        if frame.extended:
            return (
                "extended" in self.heeds
                and not frame.remote
                and frame.identifier >> 18 == p.COMMAND_BASE + self.device
            )
        if frame.identifier == p.COMMAND_BASE + self.device:
            return not frame.remote or "remote" in self.heeds
        return frame.identifier in (0x07F, 0x0FF) and "neighbours" in self.heeds

    def take(self, t_ns: int, frame: Frame) -> None:
        if not self.meant(frame):
            return
        self.quick = self.quick + 1 if t_ns - self.last_ns < 5_000_000 else 0
        self.last_ns = t_ns
        if self.forgets and self.quick % self.forgets == self.forgets - 1:
            return
        if self.deaf_from and self.quick > self.deaf_from:
            self.port.accept([])
        opcode, result, parameter, value = self.result(frame.data)
        result = self.replace.get(result, result)
        late_ns = self.answer_ns if opcode in self.slow else 0
        for _ in range(self.answers):
            reply = bytearray(p.pack_reply(self.says, opcode, result, parameter, value))
            for at, more in self.twisted.items():
                reply[at] = reply[at] + more & 0xFF
            self.port.send(Frame(self.elsewhere, bytes(reply[: self.cut])), t_ns + late_ns)

    def result(self, data: bytes) -> tuple[int, int, int, int]:
        opcode = data[1] if len(data) > 1 else 0
        if len(data) != 8:
            return opcode, p.Result.WRONG_LENGTH, 0, 0
        if data[0] != self.device:
            return opcode, p.Result.WRONG_DEVICE_TYPE, 0, 0
        if opcode not in p.opcodes(self.model):
            return opcode, p.Result.UNKNOWN_OPCODE, 0, 0
        if opcode == p.Opcode.PING:
            return opcode, p.Result.OK, 0, self.health
        _, _, arguments = p.unpack_command(data)
        return opcode, *self.obey(opcode, arguments)

    def obey(self, opcode: int, arguments: tuple[int, ...]) -> tuple[int, int, int]:
        """Result, parameter, value."""
        if opcode in (p.Opcode.GET_PARAMETER, p.Opcode.SET_PARAMETER):
            return p.Result.OUT_OF_RANGE, arguments[0], 0
        if opcode != p.Opcode.BRIGHTNESS or not self.darkest <= arguments[0] <= self.brightest:
            return p.Result.OUT_OF_RANGE, 0, 0
        return p.Result.OK, 0, 0


class FakeAxis(FakeDisplay):
    """The same for an axis board, under a device type that no board of the telescope has."""

    device = 0x13
    model = p.Device.AXIS_RA

    def __init__(self, wire: Wire) -> None:
        super().__init__(wire)
        self.parameters = {number: low for number, (low, _) in PARAMETERS["AXIS"].items()}
        self.on = False
        self.beyond = "refused"
        self.looks_at_state = True
        self.heard: list[int] = []
        wire.queue.at(11_000_000, self.measure)

    def measure(self, t_ns: int) -> None:
        self.port.send(Frame(p.MEASUREMENT_BASE + self.device, bytes([self.device]) + bytes(7)), t_ns)
        if t_ns // 10_000_000 % 25 == 1:
            target = bytes([self.device, p.SUMMARY_KIND, *bytes(6)])
            self.port.send(Frame(p.SUMMARY_BASE + self.device, target), t_ns)
        self.wire.queue.at(t_ns + 10_000_000, self.measure)

    def obey(self, opcode: int, arguments: tuple[int, ...]) -> tuple[int, int, int]:
        self.heard.append(opcode)
        if opcode == p.Opcode.GET_PARAMETER:
            known = arguments[0] in self.parameters
            result = p.Result.OK if known else p.Result.OUT_OF_RANGE
            return result, arguments[0], self.parameters.get(arguments[0], 0)
        if opcode == p.Opcode.SET_PARAMETER:
            return self.set(*arguments)
        if opcode == p.Opcode.POWER:
            self.on = arguments[0] == 1
            return p.Result.OK if arguments[0] < 2 else p.Result.OUT_OF_RANGE, 0, 0
        if self.outside(opcode, arguments):
            return p.Result.OUT_OF_RANGE, 0, 0
        allowed = self.on or not self.looks_at_state or opcode == p.Opcode.STOP
        return p.Result.OK if allowed else p.Result.NOT_ALLOWED, 0, 0

    def set(self, number: int, value: int) -> tuple[int, int, int]:
        if number not in self.parameters:
            return p.Result.OUT_OF_RANGE, number, value
        low, high = PARAMETERS["AXIS"][number]
        inside = low <= value <= high
        result = p.Result.OK if inside or self.beyond == "cut" else p.Result.OUT_OF_RANGE
        if inside or self.beyond == "kept":
            self.parameters[number] = value
        elif self.beyond == "cut":
            self.parameters[number] = min(max(value, low), high)
        return result, number, self.parameters[number]

    def outside(self, opcode: int, arguments: tuple[int, ...]) -> bool:
        fastest = PARAMETERS["AXIS"][p.AxisParameter.RATE_SLEW_Q16][1]
        match opcode:
            case p.Opcode.SET_RATE | p.Opcode.TRACK_RATE:
                return abs(arguments[0]) > fastest
            case p.Opcode.OPEN_LOOP:
                return abs(arguments[0]) > 3000
            case p.Opcode.SET_CLASS:
                return not 1 <= arguments[0] <= 5 or abs(arguments[1]) > 1
            case p.Opcode.MOVE_TO:
                low, high = self.parameters[4], self.parameters[5]
                return not low <= arguments[0] <= high or (low, high) == (0, 0)
        return False


class FakePosition(FakeDisplay):
    """The same for a position board."""

    device = 0x23
    model = p.Device.POSITION_RA

    def __init__(self, wire: Wire) -> None:
        super().__init__(wire)
        self.limits = {4: 0, 5: 0}
        self.frames, self.frame_steps = 0, (1,)
        wire.queue.at(11_000_000, self.measure)

    def measure(self, t_ns: int) -> None:
        data = p.pack_position(self.device, 0, 5, 1, self.frames & 0xFF)
        self.port.send(Frame(p.MEASUREMENT_BASE + self.device, data), t_ns)
        at = t_ns // 5_000_000
        if at % 50 == 2:
            self.port.send(Frame(p.SUMMARY_BASE + self.device, p.pack_summary(self.device, 0, 5)), t_ns)
        self.frames += self.frame_steps[at % len(self.frame_steps)]
        self.wire.queue.at(t_ns + 5_000_000, self.measure)

    def obey(self, opcode: int, arguments: tuple[int, ...]) -> tuple[int, int, int]:
        number = arguments[0]
        if number not in self.limits:
            return p.Result.OUT_OF_RANGE, number, 0
        if opcode == p.Opcode.SET_PARAMETER:
            low, high = PARAMETERS["POSITION"][number]
            if not low <= arguments[1] <= high:
                return p.Result.OUT_OF_RANGE, number, self.limits[number]
            self.limits[number] = arguments[1]
        return p.Result.OK, number, self.limits[number]


BOARDS = {FakeDisplay: DISPLAY, FakeAxis: parse("axis:0x13"), FakePosition: parse("position:0x23")}


def wrong(change: Change, kind: type[FakeDisplay] = FakeDisplay) -> list[CheckResult]:
    wire = Wire(EventQueue())
    fake = kind(wire)
    change(fake)
    with SchmidtBus(wire) as bus:
        results = run(bus, devices=(BOARDS[kind],), settings=Settings(motion=True, stamps_s=0.0))
    return [result for result in results if not result.passed]


def failures(change: Change, kind: type[FakeDisplay] = FakeDisplay) -> set[tuple[str, Level]]:
    return {(result.check, result.level) for result in wrong(change, kind)}


@pytest.mark.parametrize("kind", BOARDS)
def test_a_sound_board_passes(kind: type[FakeDisplay]) -> None:
    assert failures(lambda _: None, kind) == set()


def changed(**values: object) -> Change:
    def change(fake: FakeDisplay) -> None:
        for name, value in values.items():
            setattr(fake, name, value)

    return change


MS = 1_000_000
WRONG: list[tuple[str, Change, set[str]]] = [
    ("another identifier", changed(identifier=0x7A0), {"identifier", "undocumented"}),
    ("seven bytes", changed(spoil=lambda beat: beat[:7]), {"length"}),
    ("another device type", changed(spoil=lambda beat: b"\x52" + beat[1:]), {"device type"}),
    ("a state that is none", changed(spoil=lambda beat: beat[:2] + b"\x09" + beat[3:]), {"contents"}),
    ("three percent slow", changed(beats_ns=(1030 * MS,)), {"period"}),
    ("every other heartbeat late", changed(beats_ns=(1050 * MS, 950 * MS)), {"jitter"}),
    ("heartbeats in pairs", changed(beats_ns=(400 * MS, 1600 * MS)), {"jitter", "gap"}),
    # under load its three transmit buffers are full of answers that are not due yet
    ("answers when it likes", changed(answer_ns=25 * MS), {"response time"}),
    ("answers 12 ms late", changed(answer_ns=12 * MS), {"response time"}),
    ("answers 600 ms late", changed(answer_ns=600 * MS), {"response time"}),
    ("is late with one command", changed(answer_ns=90 * MS, slow={p.Opcode.BRIGHTNESS}), {"response time"}),
    ("its uptime stands", changed(uptime_steps=0), {"uptime"}),
    ("its uptime runs at double speed", changed(uptime_steps=2), {"uptime"}),
    ("loses an interrupt a second", changed(overruns=1), {"overruns"}),
    ("disturbed on the bus", changed(tec=200), {"error counter"}),
    ("in FAULT", changed(state=p.State.FAULT), {"state"}),
    ("answers under another identifier", changed(elsewhere=0x191), {"answers"}),
    ("answers with seven bytes", changed(cut=7), {"answers"}),
    ("names another opcode", changed(twisted={1: 1}), {"answers"}),
    ("not healthy", changed(health=4), {"health"}),
    ("off", lambda fake: setattr(fake.port, "online", False), {"answers", "identifier"}),
    ("deaf", lambda fake: fake.port.accept([]), {"answers"}),
    (
        "answers twice",
        changed(answers=2),
        {
            "command", "wrong length", "wrong device type", "unknown opcode", "out of range", "still there",
            "limits", "flooding",
        },
    ),
    ("forgives wrong length", changed(replace={p.Result.WRONG_LENGTH: 0}), {"wrong length"}),
    ("forgives wrong type", changed(replace={p.Result.WRONG_DEVICE_TYPE: 0}), {"wrong device type"}),
    ("forgives unknown opcodes", changed(replace={p.Result.UNKNOWN_OPCODE: 0}), {"unknown opcode"}),
    (
        "forgives what is out of range",
        changed(replace={p.Result.OUT_OF_RANGE: 0}),
        {"out of range", "limits"},
    ),
    ("takes more than there is", changed(brightest=254), {"out of range"}),
    ("does not go down to its limit", changed(darkest=1), {"limits"}),
    ("answers remote frames", changed(heeds={"remote"}), {"remote frame"}),
    ("answers extended frames", changed(heeds={"extended"}), {"extended frame"}),
    ("answers its neighbours' frames", changed(heeds={"neighbours"}), {"unknown identifier"}),
    ("forgets under load", changed(forgets=8), {"flooding"}),
    ("breaks down under load", changed(deaf_from=20), {"flooding", "still there"}),
    ("chats in extended frames", changed(chatter=Frame(0x1234567, b"", True)), {"undocumented"}),
    (
        "answers for somebody else",
        changed(says=0x52),
        {
            "command", "wrong length", "wrong device type", "unknown opcode", "out of range", "still there",
            "limits",
        },
    ),
]  # fmt: skip
AXES: list[tuple[str, Change, set[str]]] = [
    ("moves although it is off", changed(looks_at_state=False), {"wrong state", "limits"}),
    ("keeps what it has refused", changed(beyond="kept"), {"limits"}),
    ("cuts what does not fit, and says nothing", changed(beyond="cut"), {"limits", "out of range"}),
    ("repeats another parameter's number", changed(twisted={3: 1}), {"command", "limits", "out of range"}),
]
POSITIONS: list[tuple[str, Change, set[str]]] = [
    ("its sequence stands", changed(frame_steps=(0,)), {"sequence"}),
    ("its sequence stands now and then", changed(frame_steps=(1, 1, 0)), {"sequence"}),
    ("its sequence skips", changed(frame_steps=(1, 1, 2)), {"sequence"}),
]
BROKEN = [
    pytest.param(kind, change, found, id=what)
    for kind, table in ((FakeDisplay, WRONG), (FakeAxis, AXES), (FakePosition, POSITIONS))
    for what, change, found in table
]


@pytest.mark.parametrize(("kind", "change", "found"), BROKEN)
def test_what_is_wrong_is_found(kind: type[FakeDisplay], change: Change, found: set[str]) -> None:
    assert {name for name, _ in failures(change, kind)} == found


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (changed(elsewhere=0x191), "none, twice; answered with 0x191 instead of 0x151"),
        (changed(elsewhere=0x111), "none, twice; answered with 0x111 instead of 0x151"),
        (changed(cut=7), "none, twice; answered with 7 bytes instead of 8"),
        (changed(twisted={1: 4}), "none, twice; answered for opcode 0x05 instead of 0x01"),
        (changed(answer_ns=90 * MS, slow={p.Opcode.BRIGHTNESS}), "the slowest to BRIGHTNESS"),
        (changed(tec=200), "TEC 200"),
        (changed(overruns=3), "0 at first, 12 at last"),
        (changed(uptime_steps=0), "0 s more"),
    ],
)
def test_what_came_instead_is_shown(change: Change, said: str) -> None:
    (result,) = wrong(change)
    assert said in result.observed
    assert result.level == Level.ERROR


def test_a_wrong_parameter_is_shown() -> None:
    found = {result.subject: result for result in wrong(changed(twisted={3: 2}), FakeAxis)}
    result = found["AXIS:0x13 GET_PARAMETER 1"]
    assert (result.expected, result.observed) == (
        "one reply: OK of parameter 1",
        "OK value 10 of parameter 3",
    )


KIT = """
from bus.can import Wire
from bus.registry import publish
from bus.time import EventQueue
from tests.conformance.test_checks import FakeDisplay
wire = Wire(EventQueue())
fake = FakeDisplay(wire)
fake.{name} = {value}
publish("kit", wire)
"""


@pytest.mark.slow
@pytest.mark.parametrize(("name", "value", "code"), [("health", 4, 0), ("answer_ns", 12 * MS, 1)])
def test_kit_and_command_end_alike(name: str, value: int, code: int, tmp_path: Path) -> None:
    wire = Wire(EventQueue())
    setattr(FakeDisplay(wire), name, value)
    with SchmidtBus(wire) as bus:
        assert check(bus, None, Settings(stamps_s=0.0), [board_of(DISPLAY)]) == code
    done = run_kit(KIT.format(name=name, value=value), tmp_path)
    assert done.returncode == code, done.stdout + done.stderr
    assert ("1 warning" in done.stdout) == (name == "health")


def test_the_kit_has_every_check() -> None:
    seen: set[str] = set()
    for kind in BOARDS:
        wire = Wire(EventQueue())
        kind(wire)
        with SchmidtBus(wire) as bus:
            results = run(bus, devices=(BOARDS[kind],), settings=Settings(motion=True, stamps_s=0.0))
        seen |= {result.check for result in results}
    assert seen <= set(CHECKS)


def test_health_is_advice_not_law(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wire = Wire(EventQueue())
    FakeDisplay(wire).health = 1
    path = tmp_path / "found.json"
    # Ten boards of the protocol are missing here, so the verdict is against it, with one line for each.
    with SchmidtBus(wire) as bus:
        assert check(bus, path, Settings()) == 1
    found = json.loads(path.read_text())
    assert found["format"] == "schmidt-conformance 2"
    assert found["issue"] == 1
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
