"""`--console [HOST:]PORT`: the consoles in a browser, on the host of the served network."""

from __future__ import annotations

import os
import secrets
import sys
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

from bus.can.frame import Frame
from bus.protocol import Device
from host.console.server import Consoles
from host.console.views import Node, SeenFrame
from host.logs.axis import AxisLog
from host.outside import Service
from host.serial_link import SerialLink
from scenarios.doors.address import address, is_local, listen
from scenarios.doors.control import TOKEN_VARIABLE
from scenarios.doors.door import DoorError
from scenarios.doors.host import HostDoor
from scenarios.doors.lines import Feed
from scenarios.doors.served import Served
from scenarios.session import log_headers

KEPT = 200
AXES = {"ra": Device.AXIS_RA, "dec": Device.AXIS_DEC}


class EmulatedBus:
    """The wire as the bus page shows it. `poll` does what the page asked for, between two slices."""

    def __init__(self, served: Served) -> None:
        self._served = served
        self._frames: deque[tuple[int, Frame, str]] = deque(maxlen=KEPT)
        self._wanted: deque[tuple[str, bool]] = deque()
        served.network.wire.tap(self._tap)

    def _tap(self, t_ns: int, frame: Frame, sender: str) -> None:
        self._frames.append((t_ns, frame, sender))

    def nodes(self) -> list[Node]:
        """Boards and whoever else is attached."""
        boards = self._served.network.boards
        found = []
        for port in self._served.network.wire.ports:
            on = boards[port.name].on if port.name in boards else port.online
            found.append(Node(port.name, on, port.state, port.tec, port.rec))
        return found

    def load(self) -> float:
        """Busy share so far."""
        return self._served.network.wire.load

    def errors(self) -> dict[str, int]:
        """By cause."""
        return dict(self._served.network.wire.errors)

    def frames(self, most: int) -> list[SeenFrame]:
        """The last ones, decoded by the DBC."""
        return [_seen(*each) for each in list(self._frames)[-most:]]

    def faults(self) -> tuple[str, ...]:
        """Every board's supply can be cut."""
        return tuple(self._served.network.boards)

    def switch(self, board: str, on: bool) -> None:
        """Asked for by a page; done by `poll`."""
        self._wanted.append((board, on))

    def poll(self) -> None:
        """On the ticking thread."""
        while self._wanted:
            self._served.switch(*self._wanted.popleft())


def _seen(t_ns: int, frame: Frame, sender: str) -> SeenFrame:
    from bus.protocol.database import database

    try:
        said = database().decode_message(frame.identifier, frame.data)
        text = _words(said) if isinstance(said, dict) else ""
    except Exception:  # whatever anybody put on the bus is shown as it is
        text = "not in the protocol"
    return SeenFrame(t_ns * 1e-9, sender, frame.identifier, frame.data, text)


def _words(said: dict[str, Any]) -> str:
    """Signals of a frame; its device is the sender's column already."""
    return ", ".join(f"{name} {value}" for name, value in said.items() if name != "Device")


class RecordedRuns:
    """Axis logs from the RS232 lines. `poll` does the writing; pages only ask."""

    def __init__(self, served: Served, host: HostDoor, folder: Path) -> None:
        self.folder = folder
        self._served = served
        self._host = host
        self._wanted: deque[Callable[[], None]] = deque()
        self._open: list[tuple[str, Feed, SerialLink, AxisLog]] = []
        self._count = len(self.logs("ra"))

    @property
    def recording(self) -> bool:
        """Whether files grow."""
        return bool(self._open)

    def start(self) -> None:
        """Begin a run; the one before ends."""
        self._wanted.append(self._begin)

    def stop(self) -> None:
        """End the run."""
        self._wanted.append(self._end)

    def logs(self, axis: str) -> list[Path]:
        """Finished runs; while one is recorded it is not among them."""
        found = sorted(self.folder.glob(f"{axis}-*.csv"))
        return found[:-1] if self._open and found else found

    def command(self, axis: str, out: Path) -> list[str]:
        """The finder as its own program: it may take a minute, and the ticks must not wait for it."""
        logs = [str(path) for path in self.logs(axis)]
        program = "from scenarios.cli import main; main()"
        return [sys.executable, "-c", program, "calibrate", *logs, "--out", str(out)]

    def poll(self, now_ns: int) -> None:
        """On the ticking thread."""
        while self._wanted:
            self._wanted.popleft()()
        for _, feed, link, _ in self._open:
            data = feed.until(now_ns)
            if data:
                link.receive(now_ns, data)

    def close(self) -> None:
        """Finish what is open."""
        self._end()

    def _begin(self) -> None:
        self._end()
        self._count += 1
        headers = log_headers(self._served.scenario, self._served.model)
        for axis, device in AXES.items():
            if device.name not in self._served.lines.uarts:
                continue
            log = AxisLog(self.folder / f"{axis}-{self._count:03d}.csv", headers[axis])
            link = SerialLink(device, self._host.hosted.journal, log.packet)
            self._open.append((device.name, self._served.lines.feed(device.name), link, log))

    def _end(self) -> None:
        for name, feed, _, log in self._open:
            self._served.lines.drop(name, feed)
            log.file.close()
        self._open.clear()


class ConsoleDoor:
    """One web server. Other machines need the token (SCHMIDT_TOKEN, or one that is made up and printed)."""

    def __init__(self, where: str, token: str | None, runs: Path, host: HostDoor, served: Served) -> None:
        self.host, self.port = address(where, "--console")
        made = token or os.environ.get(TOKEN_VARIABLE) or secrets.token_urlsafe(16)
        self.name = f"--console {where}"
        if not is_local(self.host) and token is None:
            self.name += f" (open it with ?token={made})"
        self._host = host
        self._bus = EmulatedBus(served)
        self._runs = RecordedRuns(served, host, runs)
        self._consoles = Consoles(host.hosted.telescope, self._bus, self._runs, made)
        self._service: Service | None = None

    def open(self) -> None:
        """Serve; raises OSError when the port is taken."""
        try:
            listener = listen(self.host, self.port)
            self._service = self._host.outside.keep(self._consoles.serve(listener))
        except OSError as error:
            raise DoorError(f"{self.name}: {error.strerror or error}") from None

    def poll(self, now_ns: int) -> None:
        """What the pages asked for; a server that broke is noticed here."""
        self._bus.poll()
        self._runs.poll(now_ns)
        if self._service is not None:
            self._service.check()

    def close(self) -> None:
        """No more browsers."""
        if self._service is not None:
            self._service.cancel()
            self._service = None
        self._runs.close()

    def state(self) -> str:
        """How many look."""
        return f"{self._consoles.browsers} browsers"
