"""`schmidt host`: which port is whose, what a tick hands on, and how long it runs; no port is opened."""

from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from host.client import TICK_NS
from host.links.ports import CanPort, HidPort, SerialPort
from scenarios.doors import cabled_host
from scenarios.doors.cabled_host import CabledHost
from scenarios.doors.options import HostOptions

START_S = 1024.013
"""On the PC's clock, no whole number of periods."""


class Task:
    """A link's, without a thread."""

    def __init__(self, name: str, opener: "partial[Any]", inbox: Any, say: Any) -> None:
        self.name, self.inbox, self.say = name, inbox, say
        self.port = (opener.func, opener.args)
        self.told: list[str] = []

    def start(self) -> None:
        self.told.append("start")

    def close(self) -> None:
        self.told.append("close")


class Desk:
    """A host on stand-ins. clock: s since its start; slept: how long; heard: what was handed on."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.clock = 0.0
        self.folder = folder
        self.slept: list[float] = []
        self.heard: list[tuple[Any, ...]] = []
        self.printed: list[str] = []
        monkeypatch.setattr(cabled_host, "LinkTask", Task)
        monkeypatch.setattr(cabled_host, "monotonic", lambda: START_S + self.clock)
        monkeypatch.setattr(cabled_host, "sleep", self.sleep)

    def sleep(self, time_s: float) -> None:
        assert time_s >= 0.0
        self.slept.append(time_s)
        self.clock += time_s

    def hear(self, who: str) -> Any:
        return lambda *given: self.heard.append((who, *given))

    def host(self, usb: str = "unix:usb.sock", *serial: str) -> Any:
        console: Any = SimpleNamespace(print=self.printed.append)
        options = HostOptions(usb=usb, serial=serial, runs=self.folder)
        return CabledHost(options, console)

    def heard_alone(self, host: Any) -> Any:
        """The same with nothing behind it."""
        host.pc = SimpleNamespace(
            link=SimpleNamespace(receive=self.hear("link")), poll=self.hear("pc"), close=self.hear("close"),
            journal=SimpleNamespace(status=self.hear("journal")),
        )  # fmt: skip
        host.runs = SimpleNamespace(receive=self.hear("runs"))
        host._heard = SimpleNamespace(take=self.hear("bus"))
        for name in host.serial:
            host.serial[name] = SimpleNamespace(receive=self.hear(name), watch=self.hear(f"{name} watched"))
        return host


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(tmp_path, monkeypatch)


@pytest.mark.parametrize(("usb", "port"), [
    ("can:virtual:x", (CanPort, ("virtual:x",))), ("unix:usb.sock", (HidPort, ("unix:usb.sock",))),
    ("/dev/hidraw0", (HidPort, ("/dev/hidraw0",))),
])  # fmt: skip
def test_the_gateway_is_a_bus_or_a_device(usb: str, port: tuple[Any, ...], desk: Desk) -> None:
    host = desk.host(usb)
    assert (host.usb.name, host.usb.port, host.tasks) == (usb, port, [host.usb])


def test_a_bus_that_cannot_be_meant_is_refused_at_once(desk: Desk) -> None:
    with pytest.raises(ValueError, match=r'^"virtual": expected INTERFACE:CHANNEL'):
        desk.host("can:virtual")


def test_lines_are_ports_by_board(desk: Desk) -> None:
    host = desk.host("unix:u", "AXIS_RA=/dev/ttyS0", "FOCUS=a=b")
    found = [(task.name, task.port) for task in host.tasks[1:]]
    ports = [(SerialPort, ("/dev/ttyS0",)), (SerialPort, ("a=b",))]
    assert found == list(zip(("serial AXIS_RA", "serial FOCUS"), ports, strict=True))
    assert list(host.serial) == ["serial AXIS_RA", "serial FOCUS"]


@pytest.mark.parametrize("text", ["AXIS_RA", "AXIS_RA=", "DISPLAY=/dev/ttyS0", "=x", ""])
def test_a_line_that_is_none_is_refused(text: str, desk: Desk) -> None:
    with pytest.raises(ValueError, match=f'^--serial "{text}": expected BOARD=PORT, BOARD one of AXIS_RA, '):
        desk.host("unix:u", text)


def test_a_tick_hands_on_what_has_come(desk: Desk) -> None:
    """Of a line to its link and to the run that is recorded; of the gateway to the telescope and the bus."""
    host = desk.heard_alone(desk.host("unix:u", "AXIS_RA=x", "FOCUS=y"))
    host.keepers = [SimpleNamespace(poll=desk.hear("door"))]
    host.inbox.put(("serial FOCUS", b"line"))
    host.inbox.put(("unix:u", b"report"))
    host.usb.say("unix:u: open")
    desk.clock = 1.5
    host.tick()
    now = 1_500_000_000
    assert desk.heard == [
        ("serial FOCUS", now, b"line"), ("runs", now, "FOCUS", b"line"),
        ("link", now, b"report"), ("bus", now, b"report"), ("pc", now),
        ("serial AXIS_RA watched", now), ("serial FOCUS watched", now), ("door", now),
        ("journal", now, "LINK", "unix:u: open"),
    ]  # fmt: skip
    assert desk.printed == ["unix:u: open"] and host.inbox.empty()


def test_ticks_are_a_period_apart_for_as_long_as_asked(desk: Desk) -> None:
    """A tick takes a fifth of the period here; the third one is the last that begins in time."""
    host, period_s = desk.heard_alone(desk.host()), TICK_NS / 1e9
    keeper = SimpleNamespace(
        open=desk.hear("open"), close=desk.hear("shut"), door=SimpleNamespace(name="--lx200 4030")
    )
    host.keepers = [keeper]

    def tick() -> None:
        desk.hear("tick")()
        desk.clock += 0.2 * period_s

    host.tick = tick
    host.run(2.5 * period_s)
    assert desk.slept == pytest.approx([0.8 * period_s] * 3)
    assert desk.heard == [("open",), ("tick",), ("tick",), ("tick",), ("shut",), ("close",)]
    assert host.usb.told == ["start", "close"]
    assert desk.printed == ["host on unix:usb.sock with --lx200 4030; Ctrl-C ends it"]


def test_no_time_has_no_tick(desk: Desk) -> None:
    host = desk.heard_alone(desk.host())
    host.run(0.0)
    assert desk.heard == [("close",)]
    assert desk.printed == ["host on unix:usb.sock with no door; Ctrl-C ends it"]


def test_an_interrupt_ends_it_quietly(desk: Desk) -> None:
    host = desk.heard_alone(desk.host())

    def tick() -> None:
        if desk.clock > 99.0:
            raise KeyboardInterrupt
        desk.clock += 10.0

    host.tick = tick
    host.run()
    assert desk.clock > 99.0 and host.usb.told == ["start", "close"] and desk.heard == [("close",)]
