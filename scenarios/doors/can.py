"""`--can INTERFACE:CHANNEL`: a python-can bus of the outside joined to the wire."""

from functools import partial

import can

from bus.outside.door import Door as Fence
from bus.outside.external import open_bus
from scenarios.doors.door import counted
from scenarios.doors.livenetwork import LiveNetwork


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
        self._before = [0, 0, 0, 0, 0, 0]
        """Of closed fences: in, out, refused, rejected, lost on the way out, dropped by the system."""

    def open(self) -> None:
        """Open the interface; raises SpecError."""
        self._bus = bus = open_bus(self._spec)
        self.fence = Fence(self._network.queue, self._network.wire, bus, self.node, self._enter)

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
            self._before = self._counts(fence)
        if bus is not None:
            bus.shutdown()

    def _counts(self, fence: Fence | None) -> list[int]:
        if fence is None:
            return self._before
        now = (
            fence.frames_in, fence.frames_out, fence.refused, fence.rejected, fence.lost_out,
            fence.system_lost,
        )  # fmt: skip
        return [before + each for before, each in zip(self._before, now, strict=True)]

    def state(self) -> str:
        """Frames in and out, and what was not carried."""
        frames_in, frames_out, refused, rejected, lost, dropped = self._counts(self.fence)
        return counted(
            (frames_in, "frames in"),
            (frames_out, "frames out"),
            (refused, "refused (the bus was full)"),
            (dropped, "dropped by the system's buffer"),
            (rejected, "were no CAN 2.0 frames"),
            (lost, "not taken outside"),
        )
