"""`--serial tcp:[HOST:]PORT`: the five lines on five TCP ports in a row, bare bytes (pyserial: `socket://`)."""

from scenarios.doors.clients import Clients, address, listen
from scenarios.doors.door import counted
from scenarios.doors.lines import Feed
from scenarios.doors.livenetwork import LiveNetwork


class TcpDoor:
    """Five listeners, PORT for the first board of the list and so on."""

    def __init__(self, where: str, served: LiveNetwork) -> None:
        self.name = f"--serial tcp:{where}"
        self._lines = served.lines
        self.host, self.port = address(where, "--serial tcp", len(served.lines.uarts))
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
            clients.accept()
            for client in clients.all:
                client.receive()  # the boards' lines have no receiver: it goes nowhere
                client.send(data)
            clients.sweep()

    def close(self) -> None:
        """Hang up and stop listening."""
        for name, feed, clients in self._ports:
            self._lines.drop(name, feed)
            clients.close()
        self._ports.clear()

    def state(self) -> str:
        """How many came to which line, and what they were too slow for."""
        came = [(clients.came, f"at {name}") for name, clients in self._clients.items()]
        lost = sum(clients.lost for clients in self._clients.values())
        return counted(*came, (lost, "bytes lost by slow readers"))
