"""`--debug DIR`: every board's debug port (B9) as a pseudo-terminal, both ways, for `slcan` drivers."""

from collections.abc import Callable, Iterable
from functools import partial

from boards.core.debug import DebugPort
from scenarios.doors.serial_pty import PtyDoor, Source

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


class DebugDoor(PtyDoor):
    """All boards' debug ports, both ways."""

    option = "--debug "

    def _names(self) -> Iterable[str]:
        return self._live.network.debug

    def _ends(self, board: str) -> tuple[Source, Callable[[bytes], None]]:
        feed = DebugFeed(self._live.network.debug[board])
        self._close.callback(feed.close)
        return feed, partial(self._live.debug, board)
