"""Interrupt table of the display. ASSUMPTION: a PIC18 at 10 MIPS with an MCP2515; the paper names no part."""

from boards.core import Source
from boards.core.resources import COMMANDS, PIC18F4480, Ledger

FCY_HZ = 10_000_000
_FRAMES, _TEXT = 2 * 3 * 8, 3 * 20
"""Bytes of the frames of three boards, last heard and shown, and of three lines of text."""

TABLE = (
    Source(
        "refresh", priority=2, latency_cycles=12, cost_cycles=5000
    ),  # 500 us: format and shift out the text
    Source("can", priority=1, latency_cycles=12, cost_cycles=600, level=True),
)

LEDGER = Ledger(
    chip=PIC18F4480,
    buffers=COMMANDS | {"frames": _FRAMES, "text": _TEXT},
    table=TABLE,
    fcy_hz=FCY_HZ,
    window_ns=250_000_000,
)
