"""What doors on the host have in common: servers in the host's own thread, one loop for all of them."""

from collections.abc import Coroutine

from host.outside import Service
from scenarios.doors.pc import Host


class ServerDoor:
    """Keeps servers until it is closed."""

    def __init__(self, name: str, host: Host) -> None:
        self.name = name
        self._host = host
        self._services: list[Service] = []

    def keep(self, work: Coroutine[object, object, object]) -> None:
        """Serve until the door closes; raises what that raises at once, OSError for a port that is taken."""
        self._services.append(self._host.outside.keep(work))

    def poll(self, _now_ns: int) -> None:
        """Servers run by themselves; only a broken one is noticed here."""
        for service in self._services:
            service.check()

    def close(self) -> None:
        """Hang up."""
        for service in self._services:
            service.cancel()
        self._services = []
