"""Stream clients of a door: accepted, read, written, dropped, none of them ever waited for; and addresses."""

import contextlib
import select
import socket

from host.logs.files import reason
from host.outside import HEAD_BYTES, is_http

LOCAL = "127.0.0.1"


def address(text: str, option: str, ports: int = 1) -> tuple[str, int]:
    """(host, port) of `PORT`, `HOST:PORT` or `[IPv6]:PORT`; localhost when no host is given.

    ports: how many in a row are needed. Raises ValueError.
    """
    host, colon, number = text.rpartition(":")
    host = host.strip("[]") if colon else LOCAL
    if not number.isdecimal() or not number.isascii() or len(number) > 5 or "\0" in host or not host:
        raise ValueError(f'{option} "{text[:80]!s}": expected [HOST:]PORT, for example 7411')
    port = int(number)
    if not 1 <= port <= 65536 - ports:
        raise ValueError(f"{option} {port}: a port lies within 1..{65536 - ports}")
    return host, port


def is_local(host: str) -> bool:
    """Whether an address is this machine's own loopback."""
    return host in ("::1", "localhost") or host.startswith(("127.", "::ffff:127."))


def listen(host: str, port: int) -> socket.socket:
    """A listening TCP socket that never blocks; raises OSError naming the address."""
    try:
        family, _, _, _, where = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        listener = socket.socket(family, socket.SOCK_STREAM)
    except (OSError, UnicodeError) as error:
        raise OSError(f"{host}:{port} cannot be used: {reason(error)}") from None
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(where)
        listener.listen(16)
    except OSError as error:
        listener.close()
        raise OSError(f"{host}:{port} cannot be listened on: {error.strerror or error}") from None
    listener.setblocking(False)
    return listener


LIMIT = 64
"""Clients of one listener; more are turned away."""
_CHUNK = 4096
_PATIENCE_S = 60.0  # Wall time. ASSUMPTION.


class Client:
    """One connection. lost: bytes it was too slow for. What begins like HTTP comes from a web page and is
    hung up on before a byte of it is read as a command."""

    def __init__(self, connection: socket.socket, peer: str) -> None:
        connection.setblocking(False)
        with contextlib.suppress(OSError):  # a Unix socket has no such option
            # a line's bytes leave when they are through, not when the last ones have been acknowledged
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.peer = peer
        self.lost = 0
        self.gone = False
        self.ready = True
        """Whether there may be something to receive."""
        self._head = b""
        self._connection = connection
        self.number = connection.fileno()

    def receive(self) -> bytes:
        """What has come, at most 4096 bytes; nothing when nothing has, or it has gone."""
        if not self.ready:
            return b""
        try:
            data = self._connection.recv(_CHUNK)
        except BlockingIOError:
            return b""
        except OSError:
            self.gone = True
            return b""
        if not data:
            self.gone = True
        if len(self._head) < HEAD_BYTES:
            self._head = (self._head + data)[:HEAD_BYTES]
            if is_http(self._head):
                self.gone = True
                return b""
        return data

    def send(self, data: bytes) -> None:
        """Hand it over; what does not fit now is lost to this client, as on a port that is not read."""
        if not data:
            return
        try:
            self.lost += len(data) - self._connection.send(data)
        except BlockingIOError:
            self.lost += len(data)
        except OSError:
            self.gone = True

    def deliver(self, data: bytes) -> None:
        """Hand all of it over, where nothing else waits; who does not read within a minute is hung up on."""
        self._connection.settimeout(_PATIENCE_S)
        try:
            self._connection.sendall(data)
        except OSError:
            self.gone = True
        self._connection.setblocking(False)

    def close(self) -> None:
        """Hang up."""
        self.gone = True
        self._connection.close()


class Clients:
    """Those of a door, on one listening socket after the other. came: how many there have been."""

    def __init__(self) -> None:
        self.all: list[Client] = []
        self.came = 0
        self._lost = 0
        self._listener: socket.socket | None = None
        self._poll = select.poll()  # one look at all of them: most have said nothing

    @property
    def lost(self) -> int:
        """Bytes that one or another was too slow for."""
        return self._lost + sum(client.lost for client in self.all)

    def listen(self, listener: socket.socket) -> None:
        """To this socket from now on."""
        self._listener = listener
        self._poll.register(listener, select.POLLIN)

    def accept(self) -> list[Client]:
        """New ones since the last look."""
        found: list[Client] = []
        if self._listener is None:
            return found
        ready = [number for number, _ in self._poll.poll(0)]
        for client in self.all:
            client.ready = client.number in ready
        while self._listener.fileno() in ready:
            try:
                connection, peer = self._listener.accept()
            except BlockingIOError:
                break
            if len(self.all) >= LIMIT:
                connection.close()
                continue
            found.append(Client(connection, str(peer[0]) if isinstance(peer, tuple) else ""))
            self.all.append(found[-1])
            self.came += 1
            self._poll.register(connection, select.POLLIN)
        return found

    def wait(self, timeout_s: float) -> None:
        """Until one of them says something, somebody comes, or wall time is over."""
        self._poll.poll(timeout_s * 1000)

    def sweep(self) -> None:
        """Forget those who have gone."""
        for client in [each for each in self.all if each.gone]:
            self._poll.unregister(client.number)
            client.close()
            self._lost += client.lost
            self.all.remove(client)

    def close(self) -> None:
        """Hang up on everybody and stop listening."""
        for client in self.all:
            client.gone = True
        self.sweep()
        if self._listener is not None:
            self._poll.unregister(self._listener)
            self._listener.close()
            self._listener = None
