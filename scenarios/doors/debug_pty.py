"""`--debug DIR`: every board's debug port (B9) as a pseudo-terminal, both ways, for `slcan` drivers."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from boards.core.debug import DebugPort
from scenarios.doors.door import DoorError
from scenarios.doors.serial_pty import PtyPort
from scenarios.doors.served import Served

_KEPT = 4096
"""Bytes that wait for a slice; older ones are lost."""


class DebugFeed:
    """What a debug port has said since the last look."""

    def __init__(self, port: DebugPort) -> None:
        self._port = port
        self._heard = bytearray()
        port.sink = self.hear

    def hear(self, _t_ns: int, data: bytes) -> None:
        """The port has said something."""
        self._heard += data
        del self._heard[:-_KEPT]

    def until(self, _now_ns: int) -> bytes:
        """All of it, once."""
        data = bytes(self._heard)
        self._heard.clear()
        return data

    def close(self) -> None:
        """Listen no more."""
        self._port.sink = None


class DebugDoor:
    """All boards' ports."""

    def __init__(self, folder: str, served: Served) -> None:
        self.name = f"--debug {folder}"
        self._folder = Path(folder)
        self._served = served
        self.ports: list[PtyPort] = []
        self._feeds: list[DebugFeed] = []

    def open(self) -> None:
        """Make folder, terminals and names; raises OSError."""
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            for name, port in self._served.network.debug.items():
                feed = DebugFeed(port)
                self._feeds.append(feed)
                take = partial(self._served.debug, name)
                self.ports.append(PtyPort(self._folder / name, feed, take))
        except (OSError, ValueError) as error:
            self.close()
            if isinstance(error, DoorError):
                raise
            raise DoorError(f"--debug: {self._folder}: {getattr(error, 'strerror', None) or error}") from None

    def poll(self, now_ns: int) -> None:
        """Every port, both ways."""
        for port in self.ports:
            port.poll(now_ns)

    def close(self) -> None:
        """Remove all of them."""
        for feed in self._feeds:
            feed.close()
        for port in self.ports:
            port.close()
        self.ports.clear()
        self._feeds.clear()

    def state(self) -> str:
        """Who is open."""
        used = [port.link.name for port in self.ports if port.in_use]
        return f"{sum(port.heard for port in self.ports)} bytes read, in use: {', '.join(used) or 'none'}"
