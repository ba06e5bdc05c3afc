"""A processor that stands still while the chips around it go on: a hang, or masked interrupts."""

from typing import Final

from boards.core.interrupts import Line, Source
from boards.core.periodic import PeriodicBoard
from bus.can import Frame

RECEIVE_BUFFERS: Final = 2
"""Of an MCP2515 (DS20001801, section 4): what comes while both are full is lost."""
_MASK: Final = Source("halted", 1 << 30, 0, 0)
"""A routine above all others that does not end."""


class Halt:
    """Halts a board's processor from the moment it is made until `resume`.

    Interrupts are requested and not served; a second one of a kind is lost and counted. Outputs stay as they
    are, the CAN controller acknowledges and sends what is in its buffers. `hear` is what the controller does
    with a frame meanwhile; on_receive of the port has to lead there.
    """

    def __init__(self, board: PeriodicBoard, t_ns: int) -> None:
        self._board = board
        self._since_ns = t_ns
        self._boots = board.boots
        self._kept: list[Frame] = []
        cpu = board.cpu
        self._mask = Line(cpu, _MASK)
        self._running = cpu.halt(self._mask)
        calls = [board._routine, *(line.complete for line in self._running)]
        self._events = board.queue.take_out(calls.__contains__)

    @property
    def due_ns(self) -> int | None:
        """When the first interrupt was due that is not served; None: there is none."""
        return self._events[0][0] if self._events else None

    def hear(self, _t_ns: int, frame: Frame) -> None:
        """A frame that passes the filters."""
        if len(self._kept) < RECEIVE_BUFFERS:
            self._kept.append(frame)
        else:
            self._board.dropped += 1

    def resume(self, t_ns: int) -> None:
        """On from where it stood; what waits is served at once, most urgent first.

        A board that was switched off in between has forgotten all of it.
        """
        board = self._board
        board.cpu.resume(self._mask)
        if board.boots != self._boots or not board.on:
            return
        for line in self._running:
            line.end_ns += t_ns - self._since_ns
            board.queue.at(line.end_ns, line.complete)
        for due_ns, call in self._events:
            if call == board._routine:
                self._tick(due_ns, t_ns)
        for frame in self._kept:
            board._receive(t_ns, frame)
        board.cpu.dispatch(t_ns)

    def _tick(self, due_ns: int, t_ns: int) -> None:
        """The timer's routine: the first fire meanwhile has set its flag, the others found it set."""
        board = self._board
        if due_ns < t_ns:
            due_ns, lost = board.timer.late(due_ns, t_ns)
            board.cpu.top.overruns += lost
        board.queue.at(due_ns, board._routine)
