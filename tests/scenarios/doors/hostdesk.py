"""Stubs around the host's door: its pipe, its plug, its process and the wall clock."""

import subprocess
from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.doors import host_door
from scenarios.doors import pipe_messages as messages
from scenarios.doors.host_door import HostProcess
from scenarios.doors.usb import UsbFull


class Pipe:
    """Both ends in one: said is what the host will say, heard what it was told."""

    def __init__(self) -> None:
        self.said: list[Any] = []
        self.heard: list[Any] = []
        self.waits: list[float] = []
        self.broken = False

    def send(self, message: Any) -> None:
        if self.broken:
            raise OSError
        self.heard.append(message)

    def recv(self) -> Any:
        if self.broken or not self.said:
            raise EOFError
        return self.said.pop(0)

    def poll(self, timeout_s: float = 0.0) -> bool:
        self.waits.append(timeout_s)
        return bool(self.said)

    def fileno(self) -> int:
        return 0

    def __enter__(self) -> "Pipe":
        return self

    def __exit__(self, *_: object) -> None:
        self.heard.append("closed")


class Plug:
    """The cable's end."""

    def __init__(self) -> None:
        self.waiting: list[tuple[int, bytes]] = []
        self.asked: list[int] = []
        self.written: list[tuple[int, bytes]] = []
        self.full = self.unplugged = False

    def reports(self, most: int) -> list[tuple[int, bytes]]:
        self.asked.append(most)
        found, self.waiting = self.waiting, []
        return found

    def write(self, t_ns: int, data: bytes) -> None:
        if self.full:
            raise UsbFull
        self.written.append((t_ns, data))

    def unplug(self) -> None:
        self.unplugged = True


class Desk:
    """A host door over stubs. clock: wall time, s; killed: how often its process was."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.pipe, self.plug, self.clock, self.killed, self.said = Pipe(), Plug(), 0.0, 0, list[str]()
        self.started = self.waited = 0
        self.slow = False
        feed = SimpleNamespace(until=lambda now_ns: b"line" if now_ns == 7 else b"")
        self.dropped: list[str] = []
        lines = SimpleNamespace(
            uarts={"AXIS_RA": 0, "FOCUS": 0},
            feed=lambda name: feed,
            drop=lambda name, _: self.dropped.append(name),
        )
        network = SimpleNamespace(boards={"A": 0}, devices=("A",))
        served: Any = SimpleNamespace(
            scenario="s", model="m", network=network, lines=lines,
            usb=SimpleNamespace(plug=lambda name: self.plug),
            pacer=SimpleNamespace(speed=1.0), steps=None, now_ns=11,
        )  # fmt: skip
        bus = SimpleNamespace(
            fault_kinds=list, look=lambda: "bus", wish=lambda command: (command.upper(), False)
        )
        self.looks = SimpleNamespace(poll=lambda now_ns: None, taken=lambda: ["look"], wanted=False)
        poll = SimpleNamespace(register=lambda *_: None, poll=lambda _: self.pipe.said)
        monkeypatch.setattr(host_door, "EmulatedBus", lambda served: bus)
        monkeypatch.setattr(host_door, "Looks", lambda served: self.looks)
        monkeypatch.setattr(host_door, "dated", lambda scenario: f"dated {scenario}")
        monkeypatch.setattr(host_door, "log_headers", lambda *_: {})
        monkeypatch.setattr(host_door, "Pipe", lambda: (self.pipe, Pipe()))
        monkeypatch.setattr(host_door, "select", SimpleNamespace(poll=lambda: poll, POLLIN=1))
        monkeypatch.setattr(host_door, "monotonic", lambda: 1000.0 + self.clock)
        monkeypatch.setattr(subprocess, "Popen", self.start)
        options: Any = "options"
        self.served, self.door = served, HostProcess(served, options, self.said.append)

    def start(self, command: list[str], **more: Any) -> Any:
        self.started += 1
        assert (
            command[1] == "-c" and command[3] == "0" and more["pass_fds"] == [0] and more["start_new_session"]
        )
        return SimpleNamespace(kill=self.kill, wait=self.wait)

    def kill(self) -> None:
        self.killed += 1
        self.slow = False

    def wait(self, timeout_s: float = 0.0) -> None:
        self.waited += 1
        if self.slow:
            raise subprocess.TimeoutExpired("host", timeout_s)

    def opened(self) -> "Desk":
        self.pipe.said.append(("opened", [("the host", "ready")], ""))
        self.door.open()
        self.pipe.heard.clear()
        return self

    def take(self, *flags: bool) -> None:
        """The host is through with its slice."""
        watching, recording, looking = flags or (False, False, False)
        self.pipe.said.append(messages.Taken(watching, recording, looking, [("the host", "moves")]))
