"""`--console [HOST:]PORT`: the consoles in a browser, on the host of the served network."""

from __future__ import annotations

import os
import secrets
import sys
from collections import deque
from collections.abc import Callable
from pathlib import Path

from bus.protocol import Device
from host.console.server import Consoles
from host.logs.axis import AxisLog
from host.outside import Service
from host.serial_link import SerialLink
from scenarios.doors.address import address, is_local, listen
from scenarios.doors.busview import EmulatedBus
from scenarios.doors.control import TOKEN_VARIABLE
from scenarios.doors.door import DoorError
from scenarios.doors.host import HostDoor
from scenarios.doors.lines import Feed
from scenarios.doors.served import Served
from scenarios.session import log_headers

AXES = {"ra": Device.AXIS_RA, "dec": Device.AXIS_DEC}


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
