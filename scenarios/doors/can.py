"""`--can INTERFACE:CHANNEL`: a python-can bus of the outside joined to the wire."""

from functools import partial

import can

from bus.outside.door import Door as Fence
from bus.outside.external import open_bus
from scenarios.doors.door import counted
from scenarios.doors.livenetwork import LiveNetwork

_COUNTS = (
    ("frames_in", "frames in"), ("frames_out", "frames out"), ("refused", "refused (the bus was full)"),
    ("rejected", "were no CAN 2.0 frames"), ("lost_out", "not taken outside"),
)  # fmt: skip
"""What a fence counts, in words."""


class CanDoor:
    """One interface. Its node stays on the wire while the interface is away."""

    def __init__(self, spec: str, index: int, served: LiveNetwork) -> None:
        self.name = f"--can {spec}"
        self._spec = spec
        self._network = served.network
        self._enter = partial(served.frame, index)
        self.node = served.node(index)
        self._bus: can.BusABC | None = None
        self.fence: Fence | None = None
        self._fences: list[Fence] = []
        """All there have been: one each time the interface was opened."""
        self._dropped = 0

    def open(self) -> None:
        """Open the interface; raises SpecError."""
        self._bus = bus = open_bus(self._spec)
        self.fence = Fence(self._network.queue, self._network.wire, bus, self.node, self._enter)
        self._fences.append(self.fence)

    def poll(self, _now_ns: int) -> None:
        """Bring in what has arrived; what the boards say goes out as they say it."""
        if self.fence is not None:
            self.fence.poll()

    def close(self) -> None:
        """Shut the interface down."""
        fence, bus = self.fence, self._bus
        self.fence = self._bus = None
        if fence is not None:
            fence.close()
            self._dropped += fence.system_lost  # nobody knows it of an interface that is shut
        if bus is not None:
            bus.shutdown()

    def state(self) -> str:
        """Frames in and out, and what was not carried."""
        counts = [(sum(getattr(each, name) for each in self._fences), said) for name, said in _COUNTS]
        dropped = self._dropped + (0 if self.fence is None else self.fence.system_lost)
        return counted(*counts, (dropped, "dropped by the system's buffer"))
