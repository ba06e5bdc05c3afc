"""`--alpaca [HOST:]PORT`: ASCOM Alpaca telescope, focuser and cameras, and their discovery."""

from host.alpaca.discovery import serve as discover
from host.alpaca.server import Alpaca
from scenarios.doors.clients import address, is_local, listen
from scenarios.doors.door import counted
from scenarios.doors.pc import Host, ServerDoor


class AlpacaDoor(ServerDoor):
    """One HTTP port. Without discovery (port 32227 taken) it serves all the same, and says so."""

    def __init__(self, spec: str, host: Host) -> None:
        self._asked = f"--alpaca {spec}"
        super().__init__(self._asked, host)
        self.alpaca = Alpaca(host.pc.telescope, host.pc.cameras)
        self._address = address(spec, "--alpaca")

    def open(self) -> None:
        """Listen; raises OSError."""
        where, port = self._address
        self.keep(self.alpaca.serve(listen(where, port)))
        try:
            self.keep(discover(port, is_local(where)))
            self.name = self._asked
        except OSError as error:
            self.name = f"{self._asked} (no discovery: {error.strerror})"

    def state(self) -> str:
        """How much it was asked."""
        return counted((self.alpaca.requests, "requests"))
