"""The fence: joins a wire, both ways, to any python-can bus."""

from collections import deque
from collections.abc import Callable
from time import monotonic

import can

from bus.can.frame import Frame, FrameError, check
from bus.can.wire import Wire
from bus.outside.errorframes import ErrorFrames, kernel_drops, overflow_message
from bus.outside.messages import to_frame, to_message
from bus.outside.node import OutsideNode
from bus.time import EventQueue

_FRAMES_PER_POLL = 64
"""More than the wire carries in eight milliseconds; what is left waits in the system's buffer."""
_ECHO_S = 2.0
"""Wall time after which the echo of a frame is no longer expected."""
_ERROR_FRAME_S = 0.1
"""Wall time between two error frames while the controller is full."""


def echoes(bus: can.BusABC) -> bool:
    """Whether `bus` hands a sender its own frames back, unasked.

    python-can's udp_multicast does: a multicast socket hears itself, and two processes on one machine
    share address and port, so that only the content tells.
    """
    return type(bus).__module__.startswith("can.interfaces.udp_multicast")


class Door:
    """Between `external_bus` and an `OutsideNode` on the wire.

    Frames from outside are stamped with the simulated time of the `poll()` that found them and
    arbitrated like any other. Frames from the wire go out once; none that came in goes back out. When the
    node's memory is full, a frame is refused, counted, and an error frame "receive overflow" goes out. So do
    the error frames of the node's controller (`ErrorFrames`): bus off, passive, missing acknowledge.

    enter: what to do with a frame that comes in; by default it arrives at the node.
    frames_in, frames_out; refused: the wire could not carry more; rejected: no CAN 2.0 frame. lost_out: the
    interface took no more; `system_lost`: dropped by the operating system before the door saw them.
    """

    def __init__(
        self,
        queue: EventQueue,
        wire: Wire,
        external_bus: can.BusABC,
        node: OutsideNode | None = None,
        enter: Callable[[Frame], None] | None = None,
    ) -> None:
        self.frames_in = 0
        self.frames_out = 0
        self.refused = 0
        self.lost_out = 0
        self.rejected = 0
        self._bus = external_bus
        self._node = node or OutsideNode(queue, wire)
        self._enter = enter or self._node.arrive
        self._echoes: deque[tuple[float, Frame]] | None = deque() if echoes(external_bus) else None
        self._next_error_s = 0.0
        self._queue = queue
        self._node.port.on_receive = self._out
        self._errors = ErrorFrames(self._node.port, self._tell)

    def poll(self) -> None:
        """Bring in what has arrived outside; call it between slices of simulated time.

        Raises OSError or can.CanError when the interface is broken.
        """
        full = self.refused
        for _ in range(_FRAMES_PER_POLL):
            try:
                message = self._bus.recv(timeout=0)
            except can.CanError as error:
                if is_broken(error):
                    raise
                self.rejected += 1  # a datagram that is no frame of python-can's
                continue
            if message is None:
                break
            self._in(message)
        if self.refused > full:
            self._complain()

    def _in(self, message: can.Message) -> None:
        if message.is_error_frame:
            return
        try:
            frame = to_frame(message)
            check(frame)
        except (FrameError, TypeError, ValueError, OverflowError):
            self.rejected += 1
            return
        if self._is_echo(frame):
            return
        if not self._node.room:
            self.refused += 1
            return
        self._enter(frame)
        self.frames_in += 1

    def _tell(self, message: can.Message) -> None:
        """An error frame, for whoever listens outside."""
        try:
            self._bus.send(message)
        except can.CanError:
            self.lost_out += 1

    def _complain(self) -> None:
        """Say what a full controller says, a few times a second."""
        now_s = monotonic()
        if now_s >= self._next_error_s:
            self._next_error_s = now_s + _ERROR_FRAME_S
            self._tell(overflow_message(self._queue.now_ns))

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

    def _out(self, t_ns: int, frame: Frame) -> None:
        try:
            self._bus.send(to_message(frame, t_ns, is_rx=False))
        except can.CanError:  # a full or vanished interface must not stop the telescope
            self.lost_out += 1
            return
        self.frames_out += 1
        if self._echoes is not None:
            self._echoes.append((monotonic(), frame))

    @property
    def system_lost(self) -> int:
        """Frames the operating system has dropped from this door's socket (0 where it does not tell)."""
        return kernel_drops(self._bus)

    def close(self) -> None:
        """Nothing goes out any more; the external bus stays the caller's, the node on the wire."""
        self._node.port.on_receive = None
        self._errors.close()


def is_broken(error: can.CanError) -> bool:
    """Whether an error of `recv` is the interface's, not one message's: the system stands behind it."""
    cause: BaseException | None = error
    while cause is not None:
        if isinstance(cause, OSError):
            return True
        cause = cause.__cause__
    return not isinstance(error.__cause__, Exception)
