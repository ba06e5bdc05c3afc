"""`--alpaca [HOST:]PORT`: ASCOM Alpaca telescope and focuser, and their discovery."""

from __future__ import annotations

from host.alpaca import discovery
from host.alpaca.server import Alpaca
from host.outside import Service
from scenarios.doors.address import address, is_local, listen
from scenarios.doors.host import Host


class AlpacaDoor:
    """One HTTP port. Without discovery (port 32227 taken) it serves all the same, and says so."""

    def __init__(self, spec: str, host: Host) -> None:
        self.name = f"--alpaca {spec}"
        self.alpaca = Alpaca(host.hosted.telescope)
        self._address = address(spec, "--alpaca")
        self._host = host
        self._services: list[Service] = []
        self._found = "discovery off"

    def open(self) -> None:
        """Listen; raises OSError."""
        outside, (where, port) = self._host.outside, self._address
        self._services = [outside.keep(self.alpaca.serve(listen(where, port)))]
        try:
            self._services.append(outside.keep(discovery.serve(port, is_local(where))))
            self._found = "discovery on"
        except OSError as error:
            self._found = f"no discovery: {error.strerror}"

    def poll(self, _now_ns: int) -> None:
        """Servers run in their own thread; only a broken one is noticed here."""
        for service in self._services:
            service.check()

    def close(self) -> None:
        """Hang up."""
        for service in self._services:
            service.cancel()
        self._services = []

    def state(self) -> str:
        """How much it was asked."""
        return f"{self.alpaca.requests} requests, {self._found}"
