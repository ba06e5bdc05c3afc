"""Interrupt table of the position board, PIC18F4480 at 10 MIPS. Cycles are ASSUMPTIONS.

The sample routine waits for the EnDat transfer (some 55 us at 1 MHz), checks the CRC and loads the ECAN.
"""

from typing import Final

from boards.core import Source
from boards.core.resources import COMMANDS, PIC18F4480, Ledger, line
from bus.protocol import Device

FCY_HZ: Final = 10_000_000

TABLE: Final = (
    Source("sample", priority=2, latency_cycles=12, cost_cycles=1200),  # 120 us
    Source("can", priority=1, latency_cycles=12, cost_cycles=400, level=True),  # 40 us, no SPI
)

LEDGER: Final = Ledger(
    chip=PIC18F4480,
    buffers=COMMANDS | line(Device.POSITION_RA),
    table=TABLE,
    fcy_hz=FCY_HZ,
    window_ns=5_000_000,
)
