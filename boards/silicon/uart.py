"""UART to RS232: bytes take their time, packets leave one after the other."""

from collections import deque
from collections.abc import Callable
from typing import Final

from bus.time import EventQueue

BAUD: Final = 115_200
"""ASSUMPTION: the paper gives no rate. 25 samples of some 20 bytes every 250 ms need 20 kbaud; 19200
would be the minimum for the bare five columns (hardware.md 2.1)."""
BITS_PER_BYTE: Final = 10
"""Start, eight data, stop."""
BUFFERS: Final = 2
"""What the firmware keeps of what it sends: one part leaving, one waiting."""

Sink = Callable[[int, bytes], None]
"""(t_ns at which the last byte is through, the packet)."""


class Uart:
    """Transmitter. sink: whoever listens, or None (the cable is out; the board cannot tell).

    line: called with (t_ns of the first start bit, bytes) when bytes are handed in, for who needs the time
    of every byte. The byte numbered i is through `duration_ns(i + 1)` after that.
    """

    def __init__(self, queue: EventQueue, baud: int = BAUD, sink: Sink | None = None) -> None:
        self._queue = queue
        self.baud = baud
        self.sink = sink
        self.line: Sink | None = None
        self.dropped = 0
        self._free_ns = 0
        self._packets: deque[bytes] = deque()

    def duration_ns(self, length: int) -> int:
        """Time `length` bytes take on the line, ns."""
        return length * BITS_PER_BYTE * 1_000_000_000 // self.baud

    def send(self, t_ns: int, packet: bytes, left: int = 0) -> bool:
        """Start sending at `t_ns`, or when what came before is through; False (and counted) when both
        buffers are full. left: the last bytes of the packet, if `part` has taken the others."""
        if len(self._packets) >= BUFFERS:
            self.dropped += 1
            return False
        self._packets.append(packet)
        self.part(t_ns, packet[-left:])
        self._queue.at(self._free_ns, self._through)
        return True

    def part(self, t_ns: int, data: bytes) -> None:
        """Bytes of a packet that is not whole yet. They leave now; `sink` gets them with the packet."""
        start_ns = max(t_ns, self._free_ns)
        if self.line is not None:
            self.line(start_ns, data)
        self._free_ns = start_ns + self.duration_ns(len(data))

    def _through(self, t_ns: int) -> None:
        packet = self._packets.popleft()
        if self.sink is not None:
            self.sink(t_ns, packet)
