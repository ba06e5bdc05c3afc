"""A UART both ways, byte by byte, with what goes wrong on the line: overrun, framing, wrong baud rate.

`uart.py` is what the boards' packets use. What the dsPIC30F's UART and the PIC18's EUSART have in common:
OERR, FERR, a FIFO of four or two.
"""

from collections import deque
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from bus.time import EventQueue

BITS = 10
"""Start, eight data, stop."""
FIFO_DSPIC, FIFO_PIC18 = 4, 2
_NS_PER_S = 1_000_000_000


class Received(NamedTuple):
    """A byte of the receive FIFO and whether its stop bit was missing (FERR)."""

    byte: int
    framing_error: bool


def line_levels(byte: int) -> list[int]:
    """Levels of one byte on the line: start 0, data LSB first, stop 1."""
    return [0, *[byte >> k & 1 for k in range(8)], 1]


def sample(levels: list[int], sent_baud: float, baud: float) -> Received:
    """What a receiver at `baud` takes for a byte sent at `sent_baud`. It looks at the middle of each bit,
    counted from the falling edge of the start bit. After the byte the line idles high."""

    def level(bit: int) -> int:
        index = int((bit + 0.5) * sent_baud / baud)
        return levels[index] if index < len(levels) else 1

    byte = sum(level(1 + k) << k for k in range(8))
    return Received(byte, not level(BITS - 1))


class UartLine:
    """One UART. send: queues bytes; peer: whoever is at the other end of TX, or None.

    overrun (OERR): a byte came while the FIFO was full; it is lost, and so is everything after it until
    `clear_overrun`.
    """

    def __init__(self, queue: EventQueue, baud: int, depth: int = FIFO_DSPIC) -> None:
        self._queue = queue
        self._depth = depth
        self._fifo: deque[Received] = deque()
        self._busy_ns = 0
        self.baud = baud
        self.peer: UartLine | None = None
        self.overrun = False
        self.interrupt: Callable[[int], None] | None = None

    def send(self, data: bytes) -> None:
        """Put bytes on the line from now on, one after the other."""
        byte_ns = BITS * _NS_PER_S // self.baud
        self._busy_ns = max(self._busy_ns, self._queue.now_ns)
        for byte in data:
            self._busy_ns += byte_ns
            self._queue.at(self._busy_ns, partial(self._through, byte))

    def _through(self, byte: int, t_ns: int) -> None:
        if self.peer is not None:
            self.peer.hear(t_ns, line_levels(byte), self.baud)

    def send_break(self, t_ns: int) -> None:
        """The line low for a whole byte: the other end reads 0 with a framing error."""
        if self.peer is not None:
            self.peer.hear(t_ns, [0] * BITS, self.baud)

    def hear(self, t_ns: int, levels: list[int], sent_baud: float) -> None:
        """A byte has been on the line, its levels from the start bit on."""
        if self.overrun:
            return
        if len(self._fifo) >= self._depth:
            self.overrun = True
            return
        self._fifo.append(sample(levels, sent_baud, self.baud))
        if self.interrupt is not None:
            self.interrupt(t_ns)

    def read(self) -> Received | None:
        """Oldest byte of the FIFO; None: empty."""
        return self._fifo.popleft() if self._fifo else None

    @property
    def available(self) -> int:
        """Bytes in the FIFO."""
        return len(self._fifo)

    def clear_overrun(self) -> None:
        """Firmware clears OERR: the FIFO is reset, reception goes on."""
        self._fifo.clear()
        self.overrun = False
