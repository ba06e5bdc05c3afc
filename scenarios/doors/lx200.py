"""`--lx200 [HOST:]PORT|pty:NAME`: astronomers' programs that speak LX200."""

from pathlib import Path

from scenarios.doors.clients import address
from scenarios.doors.door import counted
from scenarios.doors.pc import Host, ServerDoor


class Lx200Door(ServerDoor):
    """One port or one pseudo-terminal."""

    def __init__(self, spec: str, host: Host) -> None:
        super().__init__(f"--lx200 {spec}", host)
        self._lx200 = host.pc.lx200
        self._came = 0
        kind, _, rest = spec.partition(":")
        self._pty = Path(rest) if kind == "pty" and rest else None
        self._address = ("", 0) if self._pty else address(spec, "--lx200")

    def open(self) -> None:
        """Listen, or make the pseudo-terminal; raises OSError."""
        try:
            if self._pty is not None:
                self.keep(self._lx200.serve_pty(self._pty, self._come))
            else:
                server = self._host.outside.run(self._lx200.serve_tcp(*self._address, self._come))
                self.keep(server.serve_forever())
        except OSError as error:
            raise OSError(f"{self.name}: {error.strerror or error}") from None

    def state(self) -> str:
        """How many came; of a pseudo-terminal how often somebody was heard after a silence."""
        return counted((self._came, "clients"))

    def _come(self) -> None:
        self._came += 1
