"""`--console [HOST:]PORT`: the consoles in a browser."""

import os
import secrets

from host.console.server import Consoles
from host.sky.listed import VARIABLE, listed
from scenarios.doors.clients import address, is_local, listen
from scenarios.doors.control import TOKEN_VARIABLE
from scenarios.doors.door import counted
from scenarios.doors.pc import Host, ServerDoor


class ConsoleDoor(ServerDoor):
    """One web server. Other machines need the token (SCHMIDT_TOKEN, or one that is made up and printed)."""

    def __init__(self, where: str, token: str | None, host: Host) -> None:
        self.host, self.port = address(where, "--console")
        made = token or os.environ.get(TOKEN_VARIABLE) or secrets.token_urlsafe(16)
        said = "" if is_local(self.host) or token is not None else f" (open it with ?token={made})"
        super().__init__(f"--console {where}{said}", host)
        self._runs = runs = host.runs
        try:
            runs.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OSError(f"--runs {runs.folder}: cannot be made: {error.strerror}") from None
        try:
            listed()
        except ValueError as error:
            raise OSError(f"{VARIABLE}: {error}") from None
        self._consoles = Consoles(host.pc.telescope, host.bus, runs, made)

    def open(self) -> None:
        """Serve; raises OSError when the port is taken."""
        try:
            self.keep(self._consoles.serve(listen(self.host, self.port)))
        except OSError as error:
            raise OSError(f"{self.name}: {error.strerror or error}") from None

    def poll(self, now_ns: int) -> None:
        """What the pages asked for; a server that broke is noticed here."""
        self._runs.poll()
        super().poll(now_ns)

    def close(self) -> None:
        """No more browsers."""
        super().close()
        self._runs.close()

    def state(self) -> str:
        """How much was looked at, and what was sent that no page sends."""
        return counted((self._consoles.pages, "pages shown"), (self._consoles.refused, "messages refused"))
