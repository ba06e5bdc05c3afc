"""`--alpaca [HOST:]PORT`: ASCOM Alpaca telescope, focuser and cameras, and their discovery."""

from host.alpaca import discovery
from host.alpaca.server import Alpaca
from scenarios.doors.address import address, is_local, listen
from scenarios.doors.pc import Host
from scenarios.doors.server import ServerDoor


class AlpacaDoor(ServerDoor):
    """One HTTP port. Without discovery (port 32227 taken) it serves all the same, and says so."""

    def __init__(self, spec: str, host: Host) -> None:
        super().__init__(f"--alpaca {spec}", host)
        self.alpaca = Alpaca(host.pc.telescope, host.pc.cameras)
        self._address = address(spec, "--alpaca")
        self._found = "discovery off"

    def open(self) -> None:
        """Listen; raises OSError."""
        where, port = self._address
        self.keep(self.alpaca.serve(listen(where, port)))
        try:
            self.keep(discovery.serve(port, is_local(where)))
            self._found = "discovery on"
        except OSError as error:
            self._found = f"no discovery: {error.strerror}"

    def state(self) -> str:
        """How much it was asked."""
        return f"{self.alpaca.requests} requests, {self._found}"
