"""The node that speaks on a wire for everything behind a door: what a USB-CAN adapter is on the real bus."""

from collections import deque

from bus.can.frame import Frame, check
from bus.can.wire import Wire
from bus.time import EventQueue

WAITING_LIMIT = 1000
"""Frames that may wait for a transmit buffer, as in a USB adapter's memory. ASSUMPTION."""


class OutsideNode:
    """Takes frames at the present moment, keeps their order, and arbitrates them like any other node's.

    Everything it does follows from the moments at which frames arrived: the same arrivals, the same bus. It
    stays on the bus and acknowledges when nobody is behind the door, as an adapter does whose program ended.
    """

    def __init__(self, queue: EventQueue, wire: Wire, name: str = "outside") -> None:
        self.waiting: deque[Frame] = deque()
        self._queue = queue
        self.port = wire.attach(name)
        self.port.on_sent = self._sent

    @property
    def room(self) -> int:
        """How many more frames may wait."""
        return max(0, WAITING_LIMIT - len(self.waiting))

    def arrive(self, frame: Frame) -> None:
        """A frame from outside, now. Raises FrameError when CAN 2.0 cannot carry it."""
        check(frame)
        self.waiting.append(frame)
        self._feed(self._queue.now_ns)

    def _feed(self, t_ns: int) -> None:
        while self.waiting and self.port.send(self.waiting[0], t_ns):
            self.waiting.popleft()

    def _sent(self, t_ns: int, _frame: Frame) -> None:
        self._feed(t_ns)
