"""Firmware of the auxiliary encoder board: one word of the A25s and an ENCODER frame every 10 ms.

ASSUMPTION: a synchronous serial word of 17 bits at 500 kHz, 34 us, on a PIC18F4480 like the position board.
"""

from collections.abc import Mapping

from boards.core import Source
from boards.core.declared import DeclaredBoard, Pin
from bus.protocol.nodes import AUXILIARY

_BITS = 17


class AuxiliaryBoard(DeclaredBoard):
    """Reports one turn of the encoder's shaft; which of the 10.8 it is, the on-shaft encoder tells."""

    KIND = AUXILIARY
    TABLE = (
        Source("sample", priority=2, latency_cycles=12, cost_cycles=800),  # 80 us: the word, ECAN load
        Source("can", priority=1, latency_cycles=12, cost_cycles=400, level=True),  # 40 us, no SPI
    )
    PINS = (Pin("encoder", "{side}.auxiliary"),)

    def measure(self, t_ns: int) -> Mapping[str, float]:
        """The first clock edge latches the position: the age is the routine's length."""
        position = int(self.read("encoder", t_ns)) & ((1 << _BITS) - 1)
        return {"Position": position, "Age": self.cost_ns / 1000, "Sequence": self.ticks & 0xFF}
