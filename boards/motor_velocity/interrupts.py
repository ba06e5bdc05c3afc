"""Interrupt table of the motor velocity board.

ASSUMPTION: a PIC18F4431 at 10 MIPS like the focus board, since the paper names no part and this one has
a QEI. Cycles are estimated from instruction counts.
"""

from typing import Final

from boards.core import Source
from boards.core.resources import COMMANDS, PIC18F4431, Ledger

FCY_HZ: Final = 10_000_000

TABLE: Final = (
    # 40 us: QEI, difference, SPI load of a frame
    Source("sample", priority=2, latency_cycles=12, cost_cycles=400),
    # 60 us: SPI read, dispatch, SPI load
    Source("can", priority=1, latency_cycles=12, cost_cycles=600, level=True),
)

LEDGER: Final = Ledger(chip=PIC18F4431, buffers=COMMANDS, table=TABLE, fcy_hz=FCY_HZ, window_ns=10_000_000)
