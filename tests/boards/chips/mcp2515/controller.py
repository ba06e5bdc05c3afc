"""A firmware's driver of the chip: the calls of `boards.silicon.can.CanController`, over SPI registers.

What the boards' fast controller does in one step, done as firmware does it; SPI takes no time here. Tests
compare the two frame by frame.
"""

from collections.abc import Callable, Sequence

from boards.chips.mcp2515.chip import Mcp2515
from boards.chips.mcp2515.message import BUFFER_BYTES, frame_of, identifier_image, image_of
from boards.chips.mcp2515.registers import FILTER_ADDRESSES, MASK_ADDRESSES, TXBCTRL, Mode
from bus.can import Frame, Port
from bus.can.frame import arbitration_key
from bus.time import EventQueue

TIMING_1_MBIT = (0x82, 0xD0, 0x00)
"""CNF3, CNF2, CNF1 for 16 MHz and 1 Mbit/s."""
_BUFFERS = 3


class Mcp2515Controller:
    """The chip on `port`, brought up for 1 Mbit/s; `on_receive(t_ns, frame)` for every frame it accepts."""

    def __init__(self, queue: EventQueue, port: Port, on_receive: Callable[[int, Frame], None]) -> None:
        self.port = port
        self.chip = Mcp2515(queue, port)
        self._queue = queue
        self._on_receive = on_receive
        self._loaded: list[tuple[int, int] | None] = [None] * _BUFFERS
        self._orders = 0
        self.chip.interrupt = self._serve
        self._spi(0xC0)
        self._spi(0x02, 0x28, *TIMING_1_MBIT)
        self._spi(0x02, 0x2B, 0x1F)
        self._spi(0x02, 0x60, 0x64)
        self._spi(0x02, 0x70, 0x60)
        self._spi(0x02, 0x0F, Mode.NORMAL)

    def _spi(self, *data: int) -> bytes:
        return self.chip.transfer(bytes(data))

    def accept(self, *groups: tuple[int, Sequence[int]]) -> None:
        """Masks and filters: up to two (mask, codes) groups of standard identifiers, at most two and four."""
        ordered = sorted(groups, key=lambda group: len(group[1]))
        if len(ordered) == 1:
            ordered = [(ordered[0][0], ordered[0][1][:1]), ordered[0]]
        self._spi(0x05, 0x0F, 0xE0, Mode.CONFIGURATION)
        for address, (mask, _) in zip(MASK_ADDRESSES, ordered, strict=True):
            self._spi(0x02, address, *identifier_image(mask, extended=False))
        (_, few), (_, many) = ordered
        codes = [few[0], few[-1], *many, *[many[-1]] * (4 - len(many))]
        for address, code in zip(FILTER_ADDRESSES, codes, strict=True):
            self._spi(0x02, address, *identifier_image(code, extended=False))
        self._spi(0x02, 0x60, 0x04)
        self._spi(0x02, 0x70, 0x00)
        self._spi(0x02, 0x0F, Mode.NORMAL)

    def send(self, frame: Frame, ready_ns: int) -> bool:
        """Load a buffer and request it at `ready_ns`; False: none is free."""
        if None not in self._loaded:
            return False
        buffer = self._loaded.index(None)
        self._orders += 1
        self._loaded[buffer] = (arbitration_key(frame), self._orders)
        self._spi(0x40 + 2 * buffer, *image_of(frame)[: 5 + len(frame.data)])
        self._rank()
        if ready_ns <= self._queue.now_ns:
            self._spi(0x80 | 1 << buffer)
        else:
            self._queue.at(ready_ns, lambda _t: self._request(buffer))
        return True

    def _request(self, buffer: int) -> None:
        self._spi(0x80 | 1 << buffer)

    def _rank(self) -> None:
        """TXP so that the lowest identifier goes first, of equal ones the first loaded."""
        waiting = sorted((key, buffer) for buffer, key in enumerate(self._loaded) if key is not None)
        for rank, (_, buffer) in enumerate(waiting):
            self._spi(0x05, TXBCTRL[buffer], 0x03, _BUFFERS - rank)

    def _serve(self, t_ns: int, asserted: bool) -> None:
        """Interrupt: free what was sent, fetch what has come."""
        if not asserted:
            return
        flags = self._spi(0x03, 0x2C, 0)[2]
        for buffer in range(_BUFFERS):
            if flags >> (2 + buffer) & 1:
                self._loaded[buffer] = None
        if flags & 0x1C:
            self._spi(0x05, 0x2C, flags & 0x1C, 0)
        for buffer in (0, 1):
            if flags >> buffer & 1:
                self._on_receive(t_ns, frame_of(self._spi(0x90 | buffer << 2, *bytes(BUFFER_BYTES))[1:]))
