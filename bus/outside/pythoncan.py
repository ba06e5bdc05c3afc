"""The wire as a python-can interface: `can.Bus(interface="schmidt", channel="lab")`."""

from collections import deque
from collections.abc import Sequence
from itertools import count
from math import ceil
from typing import Any

import can
from can.typechecking import CanFilters

from bus.can.frame import Frame, FrameError
from bus.can.wire import MAX_BITRATE, Wire
from bus.outside.errorframes import ErrorFrames
from bus.outside.messages import to_frame, to_message
from bus.registry import named

_SEND_TIMEOUT_S = 1.0
_NS_PER_S = 1_000_000_000
_numbers = count(1)
_STATES = {
    "active": can.BusState.ACTIVE,
    "passive": can.BusState.PASSIVE,
    "bus_off": can.BusState.ERROR,
}


class SchmidtBus(can.BusABC):
    """One node on an in-process wire.

    channel: a name (see `bus.registry`) or a Wire. Time is simulated: `recv(1.0)` lets at most one
        simulated second
    go by, and returns as soon as a frame is there; nothing happens between calls. Time stamps are
    simulated seconds. drive=False: somebody else runs the event queue (a Pacer); recv then returns
    what has arrived and never waits. bitrate counts only for the first bus that opens a name. error_frames:
    whether error frames are received (`ErrorFrames`), as a SocketCAN socket does; no filter applies
    to them. A node alone on its wire gets no acknowledge, as on the real bus: its frames stay unsent.
    Not thread-safe: `can.Notifier` and `send_periodic` are threads on wall time and have no business here.
    """

    def __init__(
        self,
        channel: str | Wire = "lab",
        can_filters: CanFilters | None = None,
        bitrate: int = MAX_BITRATE,
        receive_own_messages: bool = False,
        drive: bool = True,
        error_frames: bool = True,
        **kwargs: Any,
    ) -> None:
        self.wire = channel if isinstance(channel, Wire) else named(channel, int(bitrate))
        name = "wire" if isinstance(channel, Wire) else channel
        self.channel_info = f"schmidt {name}"
        self._name = name
        self._can_protocol = can.CanProtocol.CAN_20
        self._received: deque[can.Message] = deque()
        self._drive = drive
        self.port = self.wire.attach(f"python-can {next(_numbers)}")
        self.port.on_receive = self._take
        if receive_own_messages:
            self.port.on_sent = self._take_own
        self._errors = ErrorFrames(self.port, self._received.append, name) if error_frames else None
        super().__init__(channel=name, can_filters=can_filters, **kwargs)

    def _take(self, t_ns: int, frame: Frame) -> None:
        message = to_message(frame, t_ns, self._name)
        if self._matches_filters(message):
            self._received.append(message)

    def _take_own(self, t_ns: int, frame: Frame) -> None:
        self._received.append(to_message(frame, t_ns, self._name, is_rx=False))

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """Next frame that passes the filters; lets up to `timeout` simulated seconds go by for it.

        None: until something arrives, or nothing is left that could happen.
        """
        if not self._received and self._drive:
            self._run(timeout, lambda: bool(self._received))
        return self._received.popleft() if self._received else None

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        return self.recv(timeout), True

    def _run(self, timeout_s: float | None, done: Any) -> None:
        """Event by event until `done()` or the timeout."""
        queue = self.wire.queue
        end_ns = None if timeout_s is None else queue.now_ns + ceil(timeout_s * _NS_PER_S)
        while not done():
            next_ns = queue.next_ns()
            if next_ns is None or (end_ns is not None and next_ns > end_ns):
                if end_ns is not None:
                    queue.run_until(end_ns)
                return
            queue.run_until(next_ns)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Put a frame into a transmit buffer now.

        With all three buffers full, up to `timeout` simulated seconds (1 when None) go by until one is
        free; then CanTimeoutError. Frames CAN 2.0 cannot carry raise CanOperationError.
        """
        try:
            frame = to_frame(msg)
            if not self.port.free_buffers and self._drive:
                self._run(_SEND_TIMEOUT_S if timeout is None else timeout, lambda: self.port.free_buffers > 0)
            sent = self.port.send(frame, self.wire.queue.now_ns)
        except FrameError as error:
            raise can.CanOperationError(str(error)) from None
        if not sent:
            raise can.CanTimeoutError("no transmit buffer is free: does any other node acknowledge?")

    def _send_periodic_internal(self, msgs: Sequence[can.Message] | can.Message, *_: Any, **__: Any) -> Any:
        raise NotImplementedError("send_periodic runs on wall time; on a simulated wire use EventQueue.at")

    @property
    def state(self) -> can.BusState:
        """Error state of this node's controller."""
        return _STATES[self.port.state]

    @state.setter
    def state(self, new_state: can.BusState) -> None:
        raise NotImplementedError("the error state follows from the bus")

    def shutdown(self) -> None:
        """Leave the wire; it lives on under its name."""
        super().shutdown()
        if self._errors is not None:
            self._errors.close()
        self.wire.detach(self.port)
