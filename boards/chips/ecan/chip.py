"""ECAN in mode 0 (legacy): the stand-alone controller's logic behind the PIC18's registers.

Sources: hardware.md 3.2, 3.5; DS39637, section 23; the tables are K unless marked. PIR3 and PIE3 have the
bits of CANINTF in its order (RXB0IF, RXB1IF, TXB0IF to TXB2IF, ERRIF, WAKIF, IRXIF). Each register names the
one that it is in the stand-alone controller (address of the MCP2515).
"""

from boards.chips.mcp2515 import registers as at
from boards.chips.mcp2515.chip import Mcp2515
from bus.can import Port
from bus.time import EventQueue

LIKE: dict[str, int] = {
    "BRGCON1": 0x2A, "BRGCON2": 0x29, "BRGCON3": 0x28, "TXERRCNT": 0x1C, "RXERRCNT": 0x1D,
    **{f"TXB{n}CON": 0x30 + 0x10 * n for n in range(3)},
    **{f"TXB{n}{part}": 0x31 + 0x10 * n + k
       for n in range(3) for k, part in enumerate(("SIDH", "SIDL", "EIDH", "EIDL", "DLC"))},
    **{f"TXB{n}D{k}": 0x36 + 0x10 * n + k for n in range(3) for k in range(8)},
    **{f"RXB{n}{part}": 0x61 + 0x10 * n + k
       for n in range(2) for k, part in enumerate(("SIDH", "SIDL", "EIDH", "EIDL", "DLC"))},
    **{f"RXB{n}D{k}": 0x66 + 0x10 * n + k for n in range(2) for k in range(8)},
    **{f"RXM{n}{part}": 0x20 + 4 * n + k
       for n in range(2) for k, part in enumerate(("SIDH", "SIDL", "EIDH", "EIDL"))},
    **{f"RXF{n}{part}": (0x00, 0x04, 0x08, 0x10, 0x14, 0x18)[n] + k
       for n in range(6) for k, part in enumerate(("SIDH", "SIDL", "EIDH", "EIDL"))},
}  # fmt: skip
OWN = ("CANCON", "CANSTAT", "COMSTAT", "PIR3", "PIE3", "RXB0CON", "RXB1CON")

RXFUL = 0x80
"""RXBnCON: the buffer is full until the firmware clears this."""
RXM, RXRTRRO, RXB0DBEN, JTOFF = 0x60, 0x08, 0x04, 0x02
ABAT = 0x10
"""CANCON 4; the requested mode is in 7:5, as in the stand-alone chip."""
COMSTAT_OF_EFLG: tuple[tuple[int, int], ...] = (
    (0x40, 0x80), (0x80, 0x40), (0x20, 0x20), (0x10, 0x10), (0x08, 0x08),
    (0x04, 0x04), (0x02, 0x02), (0x01, 0x01),
)  # fmt: skip
"""(EFLG bit, COMSTAT bit): RXB0OVFL, RXB1OVFL, TXBO, TXBP, RXBP, TXWARN, RXWARN, EWARN."""


FOSC_HZ = 40_000_000
"""10 MIPS (hardware.md 3.5): TQ = 2 (BRP + 1) / Fosc, as in the stand-alone chip."""


class EcanError(KeyError):
    """A register that the ECAN has not got in mode 0."""


class Ecan(Mcp2515):
    """Registers by name. What differs from the stand-alone chip: a receive buffer is freed by RXFUL, and the
    flags of PIR3 are latched beside it."""

    def __init__(self, queue: EventQueue, port: Port, fosc_hz: int = FOSC_HZ) -> None:
        self._latched = 0
        self._enabled = 0
        super().__init__(queue, port, fosc_hz)

    @property
    def interrupt_pin(self) -> bool:
        """The interrupt request to the CPU: a latched flag whose enable is set."""
        return bool(self._latched & self._enabled)

    def get(self, name: str) -> int:
        """Read a register. Raises EcanError for a name that is not in the tables."""
        if name in LIKE:
            return self.read(LIKE[name])
        if name == "PIR3":
            return self._latched
        if name == "PIE3":
            return self._enabled
        if name == "CANCON":
            return self._memory[at.CANCTRL] & (0xE0 | ABAT)
        if name == "CANSTAT":
            return int(self.mode)
        if name == "COMSTAT":
            eflg = self.read(at.EFLG)
            return sum(mine for theirs, mine in COMSTAT_OF_EFLG if eflg & theirs)
        if name in OWN:
            return self._receive_control(1 if name == "RXB1CON" else 0)
        raise EcanError(f"ECAN has no register {name} in mode 0")

    def set(self, name: str, value: int) -> None:
        """Write a register. Raises EcanError for a name that is not in the tables."""
        if name in LIKE:
            self.write(LIKE[name], value)
        elif name == "PIR3":
            self._latched = value & 0xFF
            self._update_pin()
        elif name == "PIE3":
            self._enabled = value & 0xFF
            self._update_pin()
        elif name == "CANCON":
            self.write(at.CANCTRL, value & (0xE0 | ABAT))
        elif name == "COMSTAT":
            keep = (at.RX0OVR if value & 0x80 else 0) | (at.RX1OVR if value & 0x40 else 0)
            self.write(at.EFLG, self._memory[at.EFLG] & keep)
        elif name in ("RXB0CON", "RXB1CON"):
            self._set_receive_control(int(name[3]), value)
        elif name not in OWN:
            raise EcanError(f"ECAN has no register {name} in mode 0")

    def _receive_control(self, buffer: int) -> int:
        theirs = self._memory[at.RXBCTRL[buffer]]
        full = RXFUL if self._memory[at.CANINTF] >> buffer & 1 else 0
        if buffer:
            return full | theirs & (RXM | RXRTRRO | 7)
        double = (RXB0DBEN | JTOFF) if theirs & at.BUKT else 0
        return full | theirs & (RXM | RXRTRRO | 1) | double

    def _set_receive_control(self, buffer: int, value: int) -> None:
        """RXFUL can only be cleared by firmware; RXB0DBEN lets a full buffer 0 roll over."""
        self.write(at.RXBCTRL[buffer], value & RXM | (value & RXB0DBEN if not buffer else 0))
        if not value & RXFUL:
            self.modify(at.CANINTF, 1 << buffer, 0)

    def _set_flags(self, flags: int, clear: int = 0) -> None:
        self._latched |= flags
        super()._set_flags(flags, clear)
