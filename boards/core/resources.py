"""The chip of a board against its firmware: RAM that its buffers take, time that its routines take.

Buffers are those that constants of the code size. Plain variables are counted where the firmware is C
(`memory_bytes`). Flash is not counted: no compiler for these chips is at hand.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from boards.core.board import INBOX
from boards.core.interrupts import Source
from boards.silicon.uart import BUFFERS
from bus.protocol import FRAME_BYTES
from bus.protocol.serial import SAMPLES, packet_bytes, sample_bytes

STACK_BYTES: Final = 128
"""ASSUMPTION: two nested routines with their registers and a call depth of six."""
COMMANDS: Final = {"commands": INBOX * (FRAME_BYTES + 1), "late reply": FRAME_BYTES}
"""Buffers of every board, bytes: commands with their length, and a reply that found no transmit buffer."""


@dataclass(frozen=True, kw_only=True)
class Chip:
    """ram, flash: bytes, as the part's family table has them (general knowledge: no page was retrieved)."""

    name: str
    ram: int
    flash: int


DSPIC30F3011: Final = Chip(name="dsPIC30F3011", ram=1024, flash=24 * 1024)
PIC18F4431: Final = Chip(name="PIC18F4431", ram=768, flash=16 * 1024)
PIC18F4480: Final = Chip(name="PIC18F4480", ram=768, flash=16 * 1024)
PIC18F4550: Final = Chip(name="PIC18F4550", ram=2048, flash=32 * 1024)


@dataclass(frozen=True, kw_only=True)
class Ledger:
    """buffers: bytes by what they hold. table, fcy_hz: the routines. extra_cycles: the most that options add
    to the first of them. window_ns: every routine may be requested once in it, and not twice.
    """

    chip: Chip
    buffers: Mapping[str, int]
    table: tuple[Source, ...]
    fcy_hz: int
    window_ns: int
    extra_cycles: int = 0

    @property
    def ram(self) -> int:
        """Bytes that buffers and stack take."""
        return sum(self.buffers.values()) + STACK_BYTES

    @property
    def busy_ns(self) -> int:
        """Time until the last routine ends, all of them requested at once, ns."""
        cycles = self.extra_cycles + sum(row.latency_cycles + row.cost_cycles for row in self.table)
        return -(-cycles * 1_000_000_000 // self.fcy_hz)


def line(device: int) -> dict[str, int]:
    """Buffers of an RS232 line, bytes: samples that become a packet, and packets that leave."""
    return {"samples": SAMPLES * sample_bytes(device), "packets": BUFFERS * packet_bytes(device)}
