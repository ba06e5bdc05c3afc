"""Interrupt table of the focus board, PIC18F4431 at 10 MIPS. Cycles are ASSUMPTIONS.

The PWM channel that makes the LVDT's 2 kHz carrier runs by itself and needs no routine.
"""

from typing import Final

from boards.core import Source
from boards.core.resources import COMMANDS, PIC18F4431, Ledger, line
from bus.protocol import Device

FCY_HZ: Final = 10_000_000

TABLE: Final = (
    Source("sample", priority=3, latency_cycles=12, cost_cycles=500),  # 50 us: QEI, ADC, SPI load
    Source("step", priority=2, latency_cycles=12, cost_cycles=150),  # 15 us: table look-up, ramp, port
    Source("can", priority=1, latency_cycles=12, cost_cycles=600, level=True),
)

LEDGER: Final = Ledger(
    chip=PIC18F4431, buffers=COMMANDS | line(Device.FOCUS), table=TABLE, fcy_hz=FCY_HZ, window_ns=2_500_000
)
"""window_ns: between two half steps at the top rate, 400/s."""
