"""Interrupt table of the gateway, PIC18F4550 at 12 MIPS. Cycles are ASSUMPTIONS.

Copying a received frame into the ring costs some 25 us; it changes memory only, so it is not a row.
"""

from typing import Final

from boards.core import Source

FCY_HZ: Final = 12_000_000

TABLE: Final = (
    Source("second", priority=3, latency_cycles=12, cost_cycles=300),
    Source("can", priority=2, latency_cycles=12, cost_cycles=600, level=True),
    Source("usb", priority=1, latency_cycles=12, cost_cycles=1200, level=True),  # 100 us: unpack a report
)
