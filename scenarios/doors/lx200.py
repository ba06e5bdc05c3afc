"""`--lx200 [HOST:]PORT|pty:NAME`: astronomers' programs that speak LX200."""

from __future__ import annotations

from pathlib import Path

from host.lx200.server import Lx200
from host.outside import Service
from scenarios.doors.address import address
from scenarios.doors.door import DoorError
from scenarios.doors.host import Host


class Lx200Door:
    """One port or one pseudo-terminal."""

    def __init__(self, spec: str, host: Host, lx200: Lx200) -> None:
        self.name = f"--lx200 {spec}"
        self._host = host
        self._lx200 = lx200
        self._service: Service | None = None
        kind, _, rest = spec.partition(":")
        self._pty = Path(rest) if kind == "pty" and rest else None
        self._address = ("", 0) if self._pty else address(spec, "--lx200")

    def open(self) -> None:
        """Listen, or make the pseudo-terminal; raises OSError."""
        outside = self._host.outside
        try:
            if self._pty is not None:
                self._service = outside.keep(self._lx200.serve_pty(self._pty))
            else:
                server = outside.run(self._lx200.serve_tcp(*self._address))
                self._service = outside.keep(server.serve_forever())
        except OSError as error:
            raise DoorError(f"{self.name}: {error.strerror or error}") from None

    def poll(self, _now_ns: int) -> None:
        """Servers run in their own thread; only a broken one is noticed here."""
        if self._service is not None:
            self._service.check()

    def close(self) -> None:
        """Hang up."""
        if self._service is not None:
            self._service.cancel()
            self._service = None

    def state(self) -> str:
        """How many are connected, on all LX200 doors."""
        return f"{self._lx200.clients} clients over TCP"
