"""Stream clients of a door: accepted, read, written, dropped, and none of them ever waited for."""

from __future__ import annotations

import contextlib
import socket

LIMIT = 64
"""Clients of one listener; more are turned away."""
_CHUNK = 4096


class Client:
    """One connection. lost: bytes it was too slow for."""

    def __init__(self, connection: socket.socket, peer: str) -> None:
        connection.setblocking(False)
        with contextlib.suppress(OSError):  # a Unix socket has no such option
            # a line's bytes leave when they are through, not when the last ones have been acknowledged
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.peer = peer
        self.lost = 0
        self.gone = False
        self._connection = connection

    def receive(self) -> bytes:
        """What has come, at most 4096 bytes; nothing when nothing has, or it has gone."""
        try:
            data = self._connection.recv(_CHUNK)
        except BlockingIOError:
            return b""
        except OSError:
            self.gone = True
            return b""
        if not data:
            self.gone = True
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

    def close(self) -> None:
        """Hang up."""
        self.gone = True
        self._connection.close()


class Clients:
    """Those of one listening socket."""

    def __init__(self, listener: socket.socket) -> None:
        self.all: list[Client] = []
        self._listener = listener

    def accept(self) -> list[Client]:
        """New ones since the last look."""
        found: list[Client] = []
        while True:
            try:
                connection, peer = self._listener.accept()
            except BlockingIOError:
                break
            if len(self.all) >= LIMIT:
                connection.close()
                continue
            found.append(Client(connection, str(peer[0]) if isinstance(peer, tuple) else ""))
            self.all.append(found[-1])
        return found

    def sweep(self) -> None:
        """Forget those who have gone."""
        for client in [each for each in self.all if each.gone]:
            client.close()
            self.all.remove(client)

    def close(self) -> None:
        """Hang up on everybody and stop listening."""
        for client in self.all:
            client.close()
        self.all.clear()
        self._listener.close()
