"""`--serial tcp:[HOST:]PORT` and `rfc2217:[HOST:]PORT`: the five lines on five TCP ports in a row.

tcp is the bare byte stream (pyserial: `socket://`). rfc2217 speaks Telnet's port control option in pyserial's
own implementation (`rfc2217://`), so that a program may set what it likes. The board's side does not follow.
"""

from types import SimpleNamespace
from typing import Any

from scenarios.doors.clients import Client, Clients, address, listen
from scenarios.doors.door import counted
from scenarios.doors.lines import Feed
from scenarios.doors.livenetwork import LiveNetwork


class TcpDoor:
    """Five listeners, PORT for the first board of the list and so on."""

    kind = "tcp"

    def __init__(self, where: str, served: LiveNetwork) -> None:
        self.name = f"--serial {self.kind}:{where}"
        self._lines = served.lines
        self.host, self.port = address(where, f"--serial {self.kind}", len(served.lines.uarts))
        self._ports: list[tuple[str, Feed, Clients]] = []
        self._clients = {name: Clients() for name in served.lines.uarts}

    def open(self) -> None:
        """Listen; raises OSError."""
        try:
            for index, (name, clients) in enumerate(self._clients.items()):
                clients.listen(listen(self.host, self.port + index))
                self._ports.append((name, self._lines.feed(name), clients))
        except OSError:
            self.close()
            raise

    def poll(self, now_ns: int) -> None:
        """New clients, gone clients, and the bytes that are through by now."""
        for _, feed, clients in self._ports:
            data = feed.until(now_ns)
            for client in clients.accept():
                self.greet(client)
            for client in clients.all:
                received = client.receive()
                if received:
                    self.take(client, received)
                if data:
                    client.send(self.wrap(client, data))
                if client.gone:
                    self.forget(client)
            clients.sweep()

    def greet(self, _client: Client) -> None:
        """Somebody has come."""

    def take(self, _client: Client, _data: bytes) -> None:
        """The boards' lines have no receiver: what a client sends goes nowhere."""

    def wrap(self, _client: Client, data: bytes) -> bytes:
        """Bytes of the line as this client gets them."""
        return data

    def forget(self, _client: Client) -> None:
        """Somebody has gone."""

    def close(self) -> None:
        """Hang up and stop listening."""
        for name, feed, clients in self._ports:
            self._lines.drop(name, feed)
            for client in clients.all:
                self.forget(client)
            clients.close()
        self._ports.clear()

    def state(self) -> str:
        """How many came to which line, and what they were too slow for."""
        came = [(clients.came, f"at {name}") for name, clients in self._clients.items()]
        lost = sum(clients.lost for clients in self._clients.values())
        return counted(*came, (lost, "bytes lost by slow readers"))


class Rfc2217Door(TcpDoor):
    """The same with Telnet and port control."""

    kind = "rfc2217"

    def __init__(self, where: str, served: LiveNetwork) -> None:
        super().__init__(where, served)
        self._managers: dict[Client, Any] = {}

    def greet(self, client: Client) -> None:
        """Offer Telnet's options."""
        from serial import serial_for_url
        from serial.rfc2217 import PortManager

        settings = serial_for_url("loop://", baudrate=115_200)  # kept; nothing is sent or read through it
        self._managers[client] = PortManager(settings, SimpleNamespace(write=client.send))

    def take(self, client: Client, data: bytes) -> None:
        """Telnet commands are answered; the rest goes nowhere. Who breaks the protocol is hung up on."""
        try:
            for _ in self._managers[client].filter(data):
                pass
        except Exception:  # pyserial's parser indexes and unpacks what it is given, unchecked
            client.gone = True

    def wrap(self, client: Client, data: bytes) -> bytes:
        """Telnet's escape of 0xFF."""
        return b"".join(self._managers[client].escape(data))

    def forget(self, client: Client) -> None:
        """Its Telnet state goes with it."""
        self._managers.pop(client, None)
