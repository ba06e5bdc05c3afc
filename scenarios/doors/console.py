"""`--console [HOST:]PORT`: the consoles in a browser."""

from __future__ import annotations

import os
import secrets

from host.console.server import Consoles
from host.console.views import BusView
from host.outside import Service
from scenarios.doors.address import address, is_local, listen
from scenarios.doors.control import TOKEN_VARIABLE
from scenarios.doors.door import DoorError
from scenarios.doors.host import Host
from scenarios.doors.runs import RecordedRuns


class ConsoleDoor:
    """One web server. Other machines need the token (SCHMIDT_TOKEN, or one that is made up and printed)."""

    def __init__(
        self, where: str, token: str | None, host: Host, bus_view: BusView, runs: RecordedRuns
    ) -> None:
        self.host, self.port = address(where, "--console")
        made = token or os.environ.get(TOKEN_VARIABLE) or secrets.token_urlsafe(16)
        self.name = f"--console {where}"
        if not is_local(self.host) and token is None:
            self.name += f" (open it with ?token={made})"
        try:
            runs.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise DoorError(f"--runs {runs.folder}: cannot be made: {error.strerror}") from None
        self._host = host
        self._runs = runs
        self._consoles = Consoles(host.hosted.telescope, bus_view, runs, made)
        self._service: Service | None = None

    def open(self) -> None:
        """Serve; raises OSError when the port is taken."""
        try:
            listener = listen(self.host, self.port)
            self._service = self._host.outside.keep(self._consoles.serve(listener))
        except OSError as error:
            raise DoorError(f"{self.name}: {error.strerror or error}") from None

    def poll(self, _now_ns: int) -> None:
        """What the pages asked for; a server that broke is noticed here."""
        self._runs.poll()
        if self._service is not None:
            self._service.check()

    def close(self) -> None:
        """No more browsers."""
        if self._service is not None:
            self._service.cancel()
            self._service = None
        self._runs.close()

    def state(self) -> str:
        """How many look, and what was sent that no page sends."""
        refused = self._consoles.refused
        return f"{self._consoles.browsers} browsers" + (f", {refused} messages refused" if refused else "")
