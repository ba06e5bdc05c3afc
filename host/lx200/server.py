"""LX200 over TCP and over a pseudo-terminal: bytes to sessions, answers back in one piece."""

import asyncio
import contextlib
import fcntl
import os
import termios
import tty
from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import monotonic

from host.lx200.moving import MOVING, TAKING
from host.lx200.reading import READING
from host.lx200.session import Handbox, Session
from host.lx200.setting import SETTING
from host.outside import HEAD_BYTES, is_http
from host.telescope import AsyncDesk, Telescope

PLAIN = READING | MOVING
WITH_ARGUMENT = SETTING | TAKING
_CLIENTS = 32
"""More at once are turned away."""
_BYTES = 4096
_QUIET_S = 1.0
"""After a silence this long, answers that were not read are nobody's any more. ASSUMPTION: clients wait at
once for what they ask."""
Came = Callable[[], None]


def _nothing() -> None:
    """Nobody counts."""


class Lx200:
    """The LX200 door of one telescope; `serve_tcp` and `serve_pty` may be called as often as wanted.

    clients: how many are connected over TCP.
    """

    def __init__(self, telescope: Telescope) -> None:
        self._desk = AsyncDesk(telescope)
        self._box = Handbox(telescope.observatory.clock, telescope.observatory.name)
        self.clients = 0

    def session(self, name: str) -> Session:
        """For one client."""
        return Session(self._desk, self._box, PLAIN, WITH_ARGUMENT, name)

    async def serve_tcp(self, host: str, port: int, came: Came = _nothing) -> asyncio.Server:
        """Listen; port 0 takes a free one. Raises OSError when it is taken. came: called for each client."""
        return await asyncio.start_server(partial(self._client, came), host, port)

    async def _client(self, came: Came, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        came()
        self.clients += 1
        session = self.session(str(writer.get_extra_info("peername")))
        head = b""
        try:
            while self.clients <= _CLIENTS and (data := await reader.read(_BYTES)):
                head = (head + data)[:HEAD_BYTES]
                if is_http(head):  # a web page, whose text may hold commands
                    break
                answer = await session.feed(data)
                if answer:
                    writer.write(answer)
                    await writer.drain()
        except (ConnectionError, asyncio.CancelledError):
            pass  # the client has gone, or the door is closed
        finally:
            self.clients -= 1
            writer.close()

    async def serve_pty(self, name: Path, came: Came = _nothing) -> None:
        """A pseudo-terminal with a stable name, until cancelled. Raises OSError when the name is taken.

        came: called when somebody is heard after a silence.
        """
        master, slave = os.openpty()
        target = os.ttyname(slave)
        try:
            tty.setraw(slave)
            os.set_blocking(master, False)
            if name.is_symlink() and (not name.exists() or os.readlink(name) == target):
                name.unlink()  # of a server that is no more, whose terminal's number may be this one's
            name.symlink_to(target)
            await self._pty(master, slave, self.session(str(name)), came)
        finally:
            if name.is_symlink() and os.readlink(name) == target:
                name.unlink()
            os.close(slave)
            os.close(master)

    async def _pty(self, master: int, slave: int, session: Session, came: Came) -> None:
        heard_s = 0.0
        while True:
            await _readable(master)
            before_s, heard_s = heard_s, monotonic()
            if heard_s - before_s > _QUIET_S:
                came()
                # a port that is closed forgets what nobody has read; this end cannot see that it was
                termios.tcflush(slave, termios.TCIFLUSH)
            # INDI takes the port for itself; since this end stays open, nobody would ever free it again
            fcntl.ioctl(slave, termios.TIOCNXCL)
            with contextlib.suppress(BlockingIOError):
                answer = await session.feed(os.read(master, _BYTES))
                if answer:
                    os.write(master, answer)  # a client that does not read loses answers, nobody waits


async def _readable(descriptor: int) -> None:
    loop = asyncio.get_running_loop()
    ready: asyncio.Future[None] = loop.create_future()

    def wake() -> None:
        if not ready.done():
            ready.set_result(None)

    loop.add_reader(descriptor, wake)
    try:
        await ready
    finally:
        loop.remove_reader(descriptor)
