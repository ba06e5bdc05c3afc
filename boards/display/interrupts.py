"""Interrupt table of the display. ASSUMPTION: a PIC18 at 10 MIPS with an MCP2515; the paper names no part."""

from boards.core import Source

FCY_HZ = 10_000_000

TABLE = (
    Source(
        "refresh", priority=2, latency_cycles=12, cost_cycles=5000
    ),  # 500 us: format and shift out the text
    Source("can", priority=1, latency_cycles=12, cost_cycles=600, level=True),
)
