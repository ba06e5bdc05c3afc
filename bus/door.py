"""The fence: joins a wire, both ways, to any python-can bus."""

from collections import deque
from time import monotonic

import can

from bus.can.frame import Frame, FrameError
from bus.can.wire import Wire
from bus.messages import to_frame, to_message
from bus.time import EventQueue

_QUEUE_LIMIT = 1000
"""Frames from outside that may wait for a transmit buffer; more are lost, as in a USB adapter's buffer."""
_FRAMES_PER_POLL = 64
_ECHO_S = 2.0
"""Wall time after which the echo of a frame is no longer expected."""


def echoes(bus: can.BusABC) -> bool:
    """Whether `bus` hands a sender its own frames back, unasked.

    python-can's udp_multicast does: a multicast socket hears itself, and two processes on one machine
    share address and port, so that only the content tells.
    """
    return type(bus).__module__.startswith("can.interfaces.udp_multicast")


class Door:
    """A node "outside" on `wire` that speaks for everything behind `external_bus`.

    Frames from outside are stamped with the simulated time of the `poll()` that found them and
    arbitrated like any other. Frames from the wire go out once; none that came in goes back out.
    """

    def __init__(self, queue: EventQueue, wire: Wire, external_bus: can.BusABC) -> None:
        self.frames_in = 0
        self.frames_out = 0
        self.lost_in = 0
        self.lost_out = 0
        self.rejected = 0
        self._queue = queue
        self._bus = external_bus
        self._waiting: deque[Frame] = deque()
        self._echoes: deque[tuple[float, Frame]] | None = deque() if echoes(external_bus) else None
        self._port = wire.attach("outside")
        self._port.on_receive = self._out
        self._port.on_sent = self._sent

    def poll(self) -> None:
        """Bring in what has arrived outside; call it between slices of simulated time."""
        for _ in range(_FRAMES_PER_POLL):
            message = self._bus.recv(timeout=0)
            if message is None:
                break
            self._in(message)
        self._feed()

    def _in(self, message: can.Message) -> None:
        if message.is_error_frame:
            return
        try:
            frame = to_frame(message)
        except FrameError:
            self.rejected += 1
            return
        if self._is_echo(frame):
            return
        if len(self._waiting) >= _QUEUE_LIMIT:
            self.lost_in += 1
            return
        self._waiting.append(frame)
        self.frames_in += 1

    def _is_echo(self, frame: Frame) -> bool:
        if self._echoes is None:
            return False
        oldest = monotonic() - _ECHO_S
        while self._echoes and self._echoes[0][0] < oldest:
            self._echoes.popleft()
        for index, (_, sent) in enumerate(self._echoes):
            if sent == frame:
                del self._echoes[index]
                return True
        return False

    def _feed(self) -> None:
        while self._waiting and self._port.send(self._waiting[0], self._queue.now_ns):
            self._waiting.popleft()

    def _sent(self, _t_ns: int, _frame: Frame) -> None:
        self._feed()

    def _out(self, t_ns: int, frame: Frame) -> None:
        try:
            self._bus.send(to_message(frame, t_ns, is_rx=False))
        except can.CanError:  # a full or vanished interface must not stop the telescope
            self.lost_out += 1
            return
        self.frames_out += 1
        if self._echoes is not None:
            self._echoes.append((monotonic(), frame))

    def close(self) -> None:
        """Leave the wire; the external bus stays the caller's."""
        self._port.online = False
