"""The chip of a board against its firmware: RAM that its buffers take, time that its routines take.

Buffers are those that constants of the code size. Plain variables are counted where the firmware is C
(`memory_bytes`). So is program memory, by the chip's own compiler.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from boards.axis import config as axis
from boards.core.board import INBOX
from boards.core.declared import DeclaredBoard
from boards.core.interrupts import Source
from boards.display import firmware as display
from boards.focus import config as focus
from boards.gateway import firmware as gateway
from boards.motor_velocity import firmware as motor
from boards.position import firmware as position
from boards.silicon.hid import FRAME_NS
from boards.silicon.uart import BUFFERS
from bus.protocol import FRAME_BYTES, HARMONICS, Device
from bus.protocol.serial import ahead_bytes, packet_bytes

STACK_BYTES: Final = 128
"""ASSUMPTION: two nested routines with their registers and a call depth of six."""
COMMANDS: Final = {"commands": INBOX * (FRAME_BYTES + 1), "late reply": FRAME_BYTES}
"""Buffers of every board, bytes: commands with their length, and a reply that found no transmit buffer."""
PARAMETERS: Final = 68
"""Rows of the axis board's parameter table, 32 bits each."""


@dataclass(frozen=True, kw_only=True)
class Chip:
    """ram: bytes, as the part's family table has them (general knowledge: no page was retrieved)."""

    name: str
    ram: int


DSPIC30F3011: Final = Chip(name="dsPIC30F3011", ram=1024)
WORDS: Final = 8192
"""Instructions that a dsPIC30F3011 holds, 24 bits each (general knowledge)."""
CODE_WORDS: Final = 7000
"""At most, of the axis board in C with all options, its tables and `LIBRARY_WORDS`: 6669 with -Os, 6923 with
-O1. Compiler: the GCC 4.5 of Microchip's XC16 2.10, built from its source. What lies behind `firmware.h`, the
peripherals and the MCP2515, is left out."""
LIBRARY_WORDS: Final = 600
"""Products of 64 bits and quotients, which the code calls; plain ones in C take 358 words. ASSUMPTION."""
MSP430_WORDS: Final = 12_500
"""The same at most, by LLVM for an MSP430, which shifts place by place: where the chip's own compiler is not
at hand, this still notices code that grows."""
PIC18F4431: Final = Chip(name="PIC18F4431", ram=768)
PIC18F4480: Final = Chip(name="PIC18F4480", ram=768)
PIC18F4550: Final = Chip(name="PIC18F4550", ram=2048)


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
    """Buffers of an RS232 line, bytes: parts of a packet, the longest a sample behind its head of eight."""
    return {"parts": BUFFERS * (8 + packet_bytes(device) - 2 - ahead_bytes(device))}


AXIS: Final = Ledger(
    chip=DSPIC30F3011,
    buffers=COMMANDS | line(Device.AXIS_RA) | {"parameters": 4 * PARAMETERS},
    table=axis.TABLE,
    fcy_hz=axis.FCY_HZ,
    window_ns=5_000_000,
    extra_cycles=HARMONICS * axis.HARMONIC_CYCLES
    + axis.FRICTION_CYCLES
    + axis.SHARE_CYCLES
    + axis.OBSERVER_CYCLES
    + axis.BIAS_CYCLES
    + axis.LOCK_CYCLES
    + axis.BLEND_CYCLES,
)
POSITION: Final = Ledger(
    chip=PIC18F4480,
    buffers=COMMANDS | line(Device.POSITION_RA),
    table=position.TABLE,
    fcy_hz=position.FCY_HZ,
    window_ns=5_000_000,
)
MOTOR: Final = Ledger(
    chip=PIC18F4431, buffers=COMMANDS, table=motor.TABLE, fcy_hz=motor.FCY_HZ, window_ns=10_000_000
)
FOCUS: Final = Ledger(
    chip=PIC18F4431,
    buffers=COMMANDS | line(Device.FOCUS),
    table=focus.TABLE,
    fcy_hz=focus.FCY_HZ,
    window_ns=2_500_000,
)
"""window_ns: between two half steps at the top rate, 400/s."""
DISPLAY: Final = Ledger(
    chip=PIC18F4480,
    buffers=COMMANDS | {"frames": 2 * 3 * 8, "text": 3 * 20},
    table=display.TABLE,
    fcy_hz=display.FCY_HZ,
    window_ns=250_000_000,
)
"""Bytes of the frames of three boards, last heard and shown, and of three lines of text."""
GATEWAY: Final = Ledger(
    chip=PIC18F4550,
    buffers=COMMANDS
    | {
        "ring": gateway.RING_SLOTS * FRAME_BYTES,
        "to the bus": gateway.COMMANDS_MOST * FRAME_BYTES,
        "reports": gateway.REPORTS_MOST * 64,
    },
    table=gateway.TABLE,
    fcy_hz=gateway.FCY_HZ,
    window_ns=FRAME_NS,
)
WRITTEN: Final = {
    "AXIS": AXIS, "POSITION": POSITION, "MOTOR": MOTOR, "FOCUS": FOCUS, "DISPLAY": DISPLAY,
    "GATEWAY": GATEWAY,
}  # fmt: skip


def declared(board: DeclaredBoard) -> Ledger:
    """A declared board's chip, ASSUMPTION: that of the position board, with on-chip CAN."""
    return Ledger(
        chip=PIC18F4480,
        buffers=COMMANDS | line(board.device_type) | {"parameters": 4 * len(board.values)},
        table=board.TABLE,
        fcy_hz=board.FCY_HZ,
        window_ns=board.codecs[0].period_ns,
    )
