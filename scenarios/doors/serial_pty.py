"""`--serial pty:DIR`, `--debug DIR`: boards' lines and debug ports as pseudo-terminals, with stable names."""

import os
import select
import termios
import tty
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from functools import partial
from pathlib import Path

from boards.core.debug import DebugPort
from host.logs.files import reason
from scenarios.doors.door import counted
from scenarios.doors.lines import Feed
from scenarios.doors.livenetwork import LiveNetwork

_CHUNK = 4096


class PtyPort:
    """One line.

    number: its file descriptor. heard, lost: bytes that went to a reader, and that it was too slow for.
    take: gets what a program sends, None: the line has no receiver, it goes nowhere.
    """

    def __init__(
        self, link: Path, feed: "Feed | DebugFeed", take: Callable[[bytes], None] | None = None
    ) -> None:
        self.link = link
        self.take = take
        self.feed = feed
        self.heard = 0
        self.lost = 0
        self.in_use = False
        self.number, slave = os.openpty()
        try:
            os.set_blocking(self.number, False)
            tty.setraw(slave)
            target = os.ttyname(slave)
        finally:
            os.close(slave)  # from now on POLLHUP tells that nobody has the port open
        try:
            self._name(target)
        except OSError:
            os.close(self.number)
            raise

    def _name(self, target: str) -> None:
        if self.link.is_symlink():
            self.link.unlink()  # of an earlier run
        elif self.link.exists():
            raise OSError(f"{self.link} exists and is no symbolic link; another folder?")
        self.link.symlink_to(target)

    def poll(self, now_ns: int, state: int) -> None:
        """Put on the line what is through by now; a port that nobody has open hears nothing.

        state: the events of `number`, as poll(2) has them.
        """
        data = self.feed.until(now_ns)
        if state & select.POLLHUP:
            if self.in_use:
                self.in_use = False
                tty.setraw(self.number)
            return
        if not self.in_use:
            self.in_use = True
            termios.tcflush(self.number, termios.TCIOFLUSH)  # what the last reader left
        if state & select.POLLIN:
            self._swallow()
        if data:
            self._write(data)

    def _write(self, data: bytes) -> None:
        try:
            count = os.write(self.number, data)
        except BlockingIOError:
            count = 0
        self.heard += count
        self.lost += len(data) - count

    def _swallow(self) -> None:
        try:
            data = os.read(self.number, _CHUNK)
        except OSError:  # the reader has just gone
            return
        if self.take is not None and data:
            self.take(data)

    def close(self) -> None:
        """Take the port and its name away."""
        os.close(self.number)
        if self.link.is_symlink():
            self.link.unlink()


class PtyDoor:
    """A folder of ports: the boards' serial lines, from which they only send."""

    option = "--serial pty:"

    def __init__(self, folder: str, live: LiveNetwork) -> None:
        self.name = self.option + folder
        self._folder = Path(folder)
        self._live = live
        self.ports: list[PtyPort] = []
        self._poll = select.poll()  # one look at all of them: most have nothing to say
        self._close = ExitStack()

    def open(self) -> None:
        """Make folder, terminals and names; raises OSError."""
        self.ports.clear()
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            for name in self._names():
                port = PtyPort(self._folder / name, *self._ends(name))
                self._close.callback(port.close)
                self._poll.register(port.number, select.POLLIN)
                self._close.callback(self._poll.unregister, port.number)
                self.ports.append(port)
        except (OSError, ValueError) as error:
            self.close()
            if isinstance(error, OSError) and error.errno is None:  # it says all
                raise
            raise OSError(f"{self.option.rstrip(': ')}: {self._folder}: {reason(error)}") from None

    def _names(self) -> Iterable[str]:
        """Boards that have a port."""
        return self._live.lines.uarts

    def _ends(self, board: str) -> tuple["Feed | DebugFeed", Callable[[bytes], None] | None]:
        """Where its bytes come from, and where those go that a program sends."""
        lines = self._live.lines
        feed = lines.feed(board)
        self._close.callback(lines.drop, board, feed)
        return feed, None

    def poll(self, now_ns: int) -> None:
        """Every line, byte by byte."""
        states = dict(self._poll.poll(0))
        for port in self.ports:
            port.poll(now_ns, states.get(port.number, 0))

    def close(self) -> None:
        """Remove all of them."""
        self._close.close()

    def state(self) -> str:
        """Bytes read at each port, and those that readers were too slow for."""
        read = [(port.heard, f"bytes read at {port.link.name}") for port in self.ports]
        return counted(*read, (sum(port.lost for port in self.ports), "bytes lost by slow readers"))


_KEPT = 4096  # Bytes that wait for a slice; older ones are lost.


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
    """All boards' debug ports (B9), both ways, for `slcan` drivers."""

    option = "--debug "

    def _names(self) -> Iterable[str]:
        return self._live.network.debug

    def _ends(self, board: str) -> tuple[DebugFeed, Callable[[bytes], None]]:
        feed = DebugFeed(self._live.network.debug[board])
        self._close.callback(feed.close)
        return feed, partial(self._live.debug, board)
