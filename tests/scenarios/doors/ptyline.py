"""A port on a pseudo-terminal, what feeds it, and reads that wait for the kernel."""

import os
import select
from pathlib import Path
from typing import Any

from scenarios.doors.serial_pty import PtyPort


class Source:
    """A feed that has what it was given."""

    def __init__(self) -> None:
        self.data = b""

    def until(self, _now_ns: int) -> bytes:
        data, self.data = self.data, b""
        return data


def read(number: int, count: int) -> bytes:
    """So many bytes, however long the kernel takes for them."""
    found = b""
    while len(found) < count and select.select([number], [], [], 5.0)[0]:
        found += os.read(number, count)
    return found


class Line:
    """A port and its feed; taken: what a program has sent."""

    def __init__(self, link: Path) -> None:
        feed: Any = Source()
        self.feed = feed
        self.taken: list[bytes] = []
        self.port = PtyPort(link, feed, self.taken.append)

    def look(self, data: bytes = b"", wait_ms: int = 0) -> None:
        """wait_ms: until something is there; the kernel hands bytes over when it likes."""
        poll = select.poll()
        poll.register(self.port.number, select.POLLIN)
        self.feed.data = data
        self.port.poll(0, dict(poll.poll(wait_ms)).get(self.port.number, 0))

    def reader(self) -> int:
        return os.open(self.port.link, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
