"""The truth on its one way out: where the telescope looks, for cameras whose shutter is open."""

from host.camera.models import Look
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.lab.eye import look

PERIOD_NS = 10_000_000
"""Between two looks: 0.15″ of the sky's turn."""


class Looks:
    """Kept since they were last taken. The plant is asked between two slices, which changes nothing in it."""

    def __init__(self, served: LiveNetwork) -> None:
        self._served = served
        self._kept: list[Look] = []
        self._next_ns = 0
        self.wanted = False

    def poll(self, now_ns: int) -> None:
        """Look, when somebody wants it and it is time."""
        if self.wanted and now_ns >= self._next_ns:
            self._next_ns = now_ns + PERIOD_NS
            self._kept.append(look(self._served.network.plant, self._served.scenario, now_ns))

    def taken(self) -> list[Look]:
        """Those since the last call."""
        kept, self._kept = self._kept, []
        return kept
