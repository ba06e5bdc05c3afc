"""Parking over stand-ins: procedures side by side, words of what went wrong, and signals."""

import signal
import threading
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from bus.protocol import Device, MotionFlag, Opcode, SpeedClass
from host.client import TICK_NS, ClientError, Procedure
from host.procedures.pointing import REACH
from scenarios.doors import parking
from scenarios.doors.parking import interrupts, park
from scenarios.doors.usb import UsbFull
from tests.scenarios.doors.served import stub

RA, DEC = Device.AXIS_RA, Device.AXIS_DEC


def test_the_first_signal_asks_and_the_second_interrupts() -> None:
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    asked: list[int] = []
    with interrupts(lambda: asked.append(1)):
        signal.raise_signal(signal.SIGTERM)
        assert asked == [1]
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
    assert asked == [1]
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)] == before


def test_another_thread_gets_no_signals() -> None:
    found: list[Any] = []

    def within() -> None:
        before = signal.getsignal(signal.SIGTERM)
        with interrupts(lambda: None):
            found.append(signal.getsignal(signal.SIGTERM) is before)

    thread = threading.Thread(target=within)
    thread.start()
    thread.join(10)
    assert found == [True]


class Client:
    """Of the host: asked: what of whom; until: what was waited for, how long."""

    def __init__(self) -> None:
        self.asked: list[Any] = []
        self.ticks: list[int] = []
        self.forgotten: list[Device] = []
        self.flags: dict[Device, int | None] = {RA: 0, DEC: 0}

    def ask(self, axis: Device, *what: int) -> Iterator[None]:
        self.asked.append((axis, *what))
        yield

    def until(self, what: str, done: Any, timeout_s: float) -> Iterator[None]:
        self.asked.append((what, timeout_s))
        if not done():
            raise ClientError(what)
        yield

    def wait(self, time_s: float) -> Iterator[None]:
        self.asked.append(("wait", time_s))
        yield

    def tick(self, t_ns: int) -> None:
        self.ticks.append(t_ns)

    def forget(self, axis: Device) -> None:
        self.forgotten.append(axis)

    def motion(self, axis: Device) -> Any:
        flags = self.flags[axis]
        return None if flags is None else SimpleNamespace(flags=flags)


class Desk:
    """A way to the boards that is a stand-in. said: lines for the user."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.client = Client()
        self.link = stub(measurements={RA, DEC}, summaries={}, receive=self.receive)
        self.received: list[Any] = []
        self.written: list[Any] = []
        self.full = False
        self.powered = {RA, DEC}
        self.said: list[str] = []
        self.plug = stub(
            reports=lambda: [(3, b"r")], write=self.write, unplug=lambda: self.said.append("unplugged")
        )
        self.served = stub(
            now_ns=0, run_until=self.run_until, usb=stub(plug=lambda name: self.plug),
            entry=stub(running=True), punctual=stub(counting=True),
            scenario=stub(mount=stub(park_steps=(11, 22))),
            network=stub(boards={"AXIS_RA": 0, "AXIS_DEC": 0}),
        )  # fmt: skip
        monkeypatch.setattr(parking, "HidLink", self.plugged)
        monkeypatch.setattr(parking, "Client", lambda *_: self.client)
        monkeypatch.setattr(parking, "powered", lambda client, axis: axis in self.powered)
        self.way = parking._Way(self.served)

    def plugged(self, send: Any) -> Any:
        self.send = send
        return self.link

    def receive(self, t_ns: int, report: bytes) -> None:
        self.received.append((t_ns, report))

    def write(self, t_ns: int, report: bytes) -> None:
        if self.full:
            raise UsbFull
        self.written.append((t_ns, report))

    def run_until(self, t_ns: int) -> None:
        self.served.now_ns = t_ns


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(monkeypatch)


def steps(count: int, error: str = "") -> Procedure:
    """A procedure of so many ticks."""
    for _ in range(count):
        yield
    if error:
        raise ClientError(error)


def test_axes_go_side_by_side_to_their_own_ends(desk: Desk) -> None:
    """In ticks of the host; the longer one takes five and ends in the sixth."""
    ways = {RA: steps(5), DEC: steps(2, "lost")}
    assert desk.way.go((RA, DEC), ways.__getitem__) == {DEC: "lost"}
    assert desk.client.ticks == [TICK_NS * k for k in range(1, 7)]
    assert desk.received == [(3, b"r")] * 6 and not desk.client.forgotten


def test_an_interrupt_leaves_what_is_under_way(desk: Desk) -> None:
    def ends() -> Procedure:
        yield
        desk.way.interrupt()
        yield

    ways = {RA: ends(), DEC: steps(1)}
    assert desk.way.go((RA, DEC), ways.__getitem__) == {RA: "interrupted"}
    assert desk.client.forgotten == [RA] and not desk.way.interrupted


def test_what_does_not_fit_on_the_cable_is_lost(desk: Desk) -> None:
    desk.send(5, b"x")
    desk.full = True
    desk.send(6, b"y")
    assert desk.written == [(5, b"x")]


def told(desk: Desk, procedure: Any) -> list[Any]:
    """What a procedure asks and waits for, to its end."""
    desk.client.asked.clear()
    for _ in procedure:
        pass
    return desk.client.asked


def test_an_axis_is_heard_or_asked(desk: Desk) -> None:
    assert told(desk, desk.way.heard(RA)) == [("no frame", 1.0)]
    desk.link.measurements.clear()
    with pytest.raises(ClientError, match="no frame"):
        told(desk, desk.way.heard(RA))
    assert desk.client.asked == [("no frame", 1.0), (RA, Opcode.PING), ("no frame", 1.0)]


def test_a_move_ends_where_the_axis_says_so(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parking, "unpack_target", lambda data: stub(settled=data))
    desk.link.summaries[RA] = 1
    *asked, last = told(desk, desk.way.move(RA, 11))
    assert asked == [(RA, Opcode.TRACK_RATE, 0), (RA, Opcode.MOVE_TO, 11, SpeedClass.SLEW), ("wait", 1.0)]
    assert last[0] == "on its way" and last[1] == REACH["slew"].timeout_s
    for summaries in ({RA: 0}, {DEC: 1}):
        desk.link.summaries = summaries
        with pytest.raises(ClientError, match="on its way"):
            told(desk, desk.way.move(RA, 11))


@pytest.mark.parametrize(("flags", "rests"), [(0, True), (MotionFlag.MOVING, False), (None, False)])
def test_a_halt_waits_for_rest(flags: int | None, rests: bool, desk: Desk) -> None:
    desk.client.flags[RA] = flags
    if rests:
        assert told(desk, desk.way.halt(RA)) == [(RA, Opcode.STOP), ("does not rest", 5.0)]
    else:
        with pytest.raises(ClientError, match="does not rest"):
            told(desk, desk.way.halt(RA))


def test_motors_are_off_when_the_board_says_so(desk: Desk) -> None:
    with pytest.raises(ClientError, match="stays on"):
        told(desk, desk.way.off(RA))
    desk.powered.clear()
    assert told(desk, desk.way.off(RA)) == [(RA, Opcode.POWER, 0), ("stays on", 1.0)]


class Script:
    """Outcomes of the four walks of `park`: heard, move, halt, off; asked: which axes went."""

    def __init__(self, desk: Desk, monkeypatch: pytest.MonkeyPatch, *failed: dict[Device, str]) -> None:
        self.asked: list[list[Device]] = []
        self.failed = list(failed)
        self.goals: dict[Device, int] = {}
        monkeypatch.setattr(parking._Way, "go", self.go)
        monkeypatch.setattr(parking._Way, "move", lambda way, axis, goal: self.goals.update({axis: goal}))
        self.desk = desk

    def go(self, axes: Any, what: Any) -> dict[Device, str]:
        self.asked.append(list(axes))
        for axis in axes:
            what(axis)
        return self.failed[len(self.asked) - 1]


NOTHING: dict[Device, str] = {}
CASES = [
    ((NOTHING,) * 4, {RA, DEC}, "parked, motors off"), ((NOTHING,) * 4, {RA}, "parked, motors off"),
    ((NOTHING,) * 4, set(), "the motors were off"),
    (({RA: "no frame"}, NOTHING, NOTHING, NOTHING), {DEC},
     "AXIS_RA is silent, its motors are as they were (no frame); AXIS_DEC is parked"),
    (({RA: "no frame", DEC: "none"}, NOTHING, NOTHING, NOTHING), set(),
     "AXIS_RA is silent, its motors are as they were (no frame); "
     "AXIS_DEC is silent, its motors are as they were (none)"),
    ((NOTHING, {DEC: "stuck"}, NOTHING, NOTHING), {RA, DEC},
     "AXIS_DEC is not parked (stuck); AXIS_RA is parked"),
    ((NOTHING, {RA: "a", DEC: "b"}, {DEC: "c"}, NOTHING), {RA, DEC},
     "AXIS_RA is not parked (a); AXIS_DEC is not parked (b); AXIS_DEC did not come to rest (c)"),
    ((NOTHING, {DEC: "b"}, {DEC: "c"}, {DEC: "d"}), {RA, DEC},
     "AXIS_DEC is not parked (b); the motors of AXIS_DEC may be on (d); AXIS_RA is parked"),
    ((NOTHING, NOTHING, NOTHING, {DEC: "d"}), {RA, DEC},
     "the motors of AXIS_DEC may be on (d); AXIS_RA and AXIS_DEC are parked"),
]  # fmt: skip


@pytest.mark.parametrize(("failed", "powered", "words"), CASES)
def test_what_is_not_parked_is_told(
    failed: tuple[dict[Device, str], ...], powered: set[Device], words: str, desk: Desk,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """A board that has been heard after all is not silent."""
    script = Script(desk, monkeypatch, *failed)
    desk.link.measurements -= set(failed[0])
    desk.powered = powered
    assert park(desk.served, desk.said.append) == words
    assert desk.said == [*([parking.BEGUN] if powered else []), "unplugged"]
    assert script.asked[0] == [RA, DEC]
    assert not desk.served.entry.running and not desk.served.punctual.counting


def test_each_axis_goes_to_its_own_place(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    """What did not arrive is halted, and all that were moved are switched off."""
    script = Script(desk, monkeypatch, {RA: "late"}, {DEC: "stuck"}, NOTHING, NOTHING)
    park(desk.served, desk.said.append)
    assert script.goals == {RA: 11, DEC: 22}
    assert script.asked == [[RA, DEC], [RA, DEC], [DEC], [RA, DEC]]


def test_a_network_may_have_one_axis(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    del desk.served.network.boards["AXIS_RA"]
    script = Script(desk, monkeypatch, *[NOTHING] * 4)
    assert park(desk.served, desk.said.append) == "parked, motors off" and script.goals == {DEC: 22}
