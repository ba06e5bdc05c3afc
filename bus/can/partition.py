"""A bus in two pieces: nodes that lose the cable to the others make up a bus of their own."""

from collections.abc import Iterable
from heapq import heapify, heappush

from bus.can.frame import Frame
from bus.can.port import Port
from bus.can.wire import Tap, Wire


def move(port: Port, to: Wire, t_ns: int) -> None:
    """Take a node from its wire to another at `t_ns` (the present), with its counters and its buffers.

    What it was sending is cut off there, stays in its buffer, and is tried again here; what it was hearing it
    misses. A node that is bus off counts its recessive runs afresh.
    """
    waiting = _leave(port, t_ns)
    port._wire = to
    to.ports.append(port)
    to._unplan()
    for key, ready_ns, frame, bits in waiting:
        to._tickets += 1
        heappush(to._waiting, (key, to._tickets, max(ready_ns, t_ns), port, frame, bits))
    if port._bus_off:
        to._trouble.comes_off(port)
    to._trouble.check()
    to._await_ready()
    to._forget_routes()


def _leave(port: Port, t_ns: int) -> list[tuple[int, int, Frame, int]]:
    """Off the old wire; returns what was in the buffers, in the order in which it was loaded."""
    old = port._wire
    unplanned = old._unplan()
    mine = sorted((offer for offer in old._waiting if offer[3] is port), key=lambda offer: offer[1])
    old._waiting = [offer for offer in old._waiting if offer[3] is not port]
    heapify(old._waiting)
    if old._busy and old._sending[3] is port:
        mine.insert(0, old._sending)
        old._trouble.cut(t_ns)
    old.ports.remove(port)
    old._trouble.leaves(port)
    old._trouble.check()
    if unplanned:
        old._await_ready()
    old._forget_routes()
    return [(key, ready_ns, frame, bits) for key, _, ready_ns, _, frame, bits in mine]


class Partition:
    """Cuts `ports` off `wire` from the moment it is made; `heal` joins the two again.

    The pieces arbitrate, acknowledge and count errors each for themselves; taps stay on the first one.
    parted: a tap that hears the frames of both.
    """

    def __init__(self, wire: Wire, ports: Iterable[Port], t_ns: int, parted: Tap | None = None) -> None:
        self.piece = Wire(wire.queue, wire.bitrate)
        self._wire, self._parted = wire, parted
        if parted is not None:
            wire.tap(parted)
            self.piece.tap(parted)
        self._order = {port: place for place, port in enumerate(wire.ports)}
        for port in list(ports):
            move(port, self.piece, t_ns)

    def heal(self, t_ns: int) -> None:
        """Everybody back on one wire, in the order in which they were on it."""
        wire, order = self._wire, self._order
        if self._parted is not None:
            wire._taps.remove(self._parted)
        for port in list(self.piece.ports):
            move(port, wire, t_ns)
        wire.ports.sort(key=lambda port: order.get(port, len(order)))
