"""The five RS232 lines (L3), byte by byte: what has gone over the line until now."""

from collections import deque
from collections.abc import Mapping
from functools import partial

from boards.silicon.uart import Uart
from bus.protocol.serial import SAMPLES

_WAITING = 64 * SAMPLES
"""Parts that a feed keeps when nobody empties it, sixteen seconds; older ones are gone. ASSUMPTION."""


class Feed:
    """One listener of one line."""

    def __init__(self, uart: Uart) -> None:
        self._uart = uart
        self._packets: deque[tuple[int, bytes]] = deque()
        self._sent = 0
        """Bytes of the first packet that have been handed out."""

    def hear(self, start_ns: int, packet: bytes) -> None:
        """The first start bit of a packet, or of a part of one, goes out at `start_ns`."""
        if len(self._packets) >= _WAITING:
            self._packets.popleft()
            self._sent = 0
        self._packets.append((start_ns, packet))

    def until(self, now_ns: int) -> bytes:
        """The bytes whose stop bit is over by `now_ns` and that have not been handed out."""
        found = bytearray()
        while self._packets:
            start_ns, packet = self._packets[0]
            before = self._sent
            while self._sent < len(packet) and start_ns + self._uart.duration_ns(self._sent + 1) <= now_ns:
                self._sent += 1
            found += packet[before : self._sent]
            if self._sent < len(packet):
                break
            self._packets.popleft()
            self._sent = 0
        return bytes(found)


def _hear(feeds: list[Feed], start_ns: int, packet: bytes) -> None:
    for feed in feeds:
        feed.hear(start_ns, packet)


class Lines:
    """All lines of a network by board name; any number of feeds on each."""

    def __init__(self, uarts: Mapping[str, Uart]) -> None:
        self.uarts = dict(uarts)
        self._feeds: dict[str, list[Feed]] = {name: [] for name in uarts}
        for name, uart in uarts.items():
            uart.line = partial(_hear, self._feeds[name])

    def feed(self, name: str) -> Feed:
        """A new listener on the line of board `name`."""
        feed = Feed(self.uarts[name])
        self._feeds[name].append(feed)
        return feed

    def drop(self, name: str, feed: Feed) -> None:
        """Listen no more; twice does nothing."""
        if feed in self._feeds[name]:
            self._feeds[name].remove(feed)
