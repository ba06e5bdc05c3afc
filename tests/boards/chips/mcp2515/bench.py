"""A chip on a wire with a partner, spoken to in SPI bytes written out by hand."""

from boards.chips.mcp2515 import Mcp2515
from bus.can import Frame, Wire
from bus.time import EventQueue

NORMAL, SLEEP, LOOPBACK, LISTEN, CONFIG = 0x00, 0x20, 0x40, 0x60, 0x80
MS = 1_000_000


class Bench:
    """16 MHz and CNF 00 D0 82: 1 Mbit/s with 8 TQ, sample point 62.5 % (hardware.md 3.2)."""

    def __init__(self, bitrate: int = 1_000_000, fosc_hz: int = 16_000_000, *, errata: bool = False) -> None:
        self.queue = EventQueue()
        self.wire = Wire(self.queue, bitrate)
        port = self.wire.attach("chip")
        # without errata as a user makes it: by the default
        chip = Mcp2515(self.queue, port, fosc_hz, errata=True) if errata else None
        self.chip = chip or Mcp2515(self.queue, port, fosc_hz)
        self.partner = self.wire.attach("partner")
        self.heard: list[Frame] = []
        self.partner.on_receive = lambda _t, frame: self.heard.append(frame)
        self.pin: list[bool] = []
        self.chip.interrupt = lambda _t, asserted: self.pin.append(asserted)

    def spi(self, *data: int) -> list[int]:
        return list(self.chip.transfer(bytes(data)))

    def read(self, address: int) -> int:
        return self.spi(0x03, address, 0)[2]

    def write(self, address: int, *values: int) -> None:
        self.spi(0x02, address, *values)

    def run(self, milliseconds: float = 1.0) -> None:
        self.queue.run_until(self.queue.now_ns + round(milliseconds * MS))

    def start(self, mode: int = NORMAL, cnf: tuple[int, int, int] = (0x00, 0xD0, 0x82)) -> "Bench":
        """Bit timing, both receive buffers open for everything, then `mode`."""
        self.write(0x28, *reversed(cnf))
        self.write(0x60, 0x60)
        self.write(0x70, 0x60)
        self.mode(mode)
        assert self.read(0x0E) & 0xE0 == mode
        return self

    def mode(self, mode: int) -> None:
        self.spi(0x05, 0x0F, 0xE0, mode)

    def load(self, buffer: int, identifier: int, data: bytes = b"", txp: int = 0) -> None:
        """A standard data frame into a transmit buffer, not requested yet."""
        self.write(0x30 + 0x10 * buffer, txp)
        self.spi(0x40 + 2 * buffer, identifier >> 3, (identifier & 7) << 5, 0, 0, len(data), *data)

    def partner_sends(self, *frames: Frame) -> None:
        for frame in frames:
            assert self.partner.send(frame, self.queue.now_ns)
        self.run()
