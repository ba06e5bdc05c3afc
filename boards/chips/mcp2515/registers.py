"""Registers of the MCP2515 as tables (DS20001801 section 11 and table 11-1; hardware.md 3.2)."""

from enum import IntEnum, IntFlag

BFPCTRL, TXRTSCTRL = 0x0C, 0x0D
CANSTAT, CANCTRL = 0x0E, 0x0F
"""Both repeat at every xE and xF."""
TEC, REC = 0x1C, 0x1D
RXM0SIDH, RXM1SIDH = 0x20, 0x24
CNF3, CNF2, CNF1 = 0x28, 0x29, 0x2A
CANINTE, CANINTF, EFLG = 0x2B, 0x2C, 0x2D
TXBCTRL = (0x30, 0x40, 0x50)
RXBCTRL = (0x60, 0x70)
SIZE = 0x80
"""The address counter is taken to have 7 bits (ASSUMPTION: the data sheet maps nothing above 7Fh)."""
FILTER_ADDRESSES = (0x00, 0x04, 0x08, 0x10, 0x14, 0x18)
MASK_ADDRESSES = (RXM0SIDH, RXM1SIDH)


class Mode(IntEnum):
    """REQOP and OPMOD, bits 7:5."""

    NORMAL = 0x00
    SLEEP = 0x20
    LOOPBACK = 0x40
    LISTEN_ONLY = 0x60
    CONFIGURATION = 0x80


class Interrupt(IntFlag):
    """CANINTE and CANINTF."""

    RX0 = 0x01
    RX1 = 0x02
    TX0 = 0x04
    TX1 = 0x08
    TX2 = 0x10
    ERR = 0x20
    WAK = 0x40
    MERR = 0x80


ICOD: tuple[tuple[int, int], ...] = (
    (Interrupt.ERR, 1), (Interrupt.WAK, 2), (Interrupt.TX0, 3), (Interrupt.TX1, 4), (Interrupt.TX2, 5),
    (Interrupt.RX0, 6), (Interrupt.RX1, 7),
)  # fmt: skip
"""Interrupt code in CANSTAT 3:1, highest priority first."""

ABAT, OSM = 0x10, 0x08
"""CANCTRL: abort all, one-shot."""
ABTF, MLOA, TXERR, TXREQ, TXP = 0x40, 0x20, 0x10, 0x08, 0x03
"""TXBnCTRL."""
RXRTR, BUKT = 0x08, 0x04
"""RXBnCTRL."""
EWARN, RXWAR, TXWAR, RXEP, TXEP, TXBO, RX0OVR, RX1OVR = (1 << k for k in range(8))
"""EFLG."""
WARNING_AT, PASSIVE_ABOVE = 96, 127

CANCTRL_AT_RESET = 0x87
"""CANSTAT follows the mode, all others are 0.

Message buffers and filters are undefined in the data sheet; 0 here (ASSUMPTION).
"""

_IDENTIFIER = (0xFF, 0xEB, 0xFF, 0xFF)
"""Writable bits of SIDH, SIDL, EID8, EID0 in filters and transmit buffers."""


def _writable() -> bytes:
    """Bits that the microcontroller can change, by address."""
    mask = bytearray(SIZE)
    for address in FILTER_ADDRESSES:
        mask[address : address + 4] = bytes(_IDENTIFIER)
    for address in MASK_ADDRESSES:
        mask[address : address + 4] = bytes((0xFF, 0xE3, 0xFF, 0xFF))
    for control in TXBCTRL:
        mask[control] = TXREQ | TXP
        mask[control + 1 : control + 14] = bytes((*_IDENTIFIER, 0x4F, *[0xFF] * 8))
    mask[RXBCTRL[0]], mask[RXBCTRL[1]] = 0x60 | BUKT, 0x60
    mask[BFPCTRL], mask[TXRTSCTRL] = 0x3F, 0x07
    mask[CNF3], mask[CNF2], mask[CNF1] = 0xC7, 0xFF, 0xFF
    mask[CANINTE], mask[CANINTF], mask[EFLG] = 0xFF, 0xFF, RX0OVR | RX1OVR
    mask[CANCTRL] = 0xFF
    return bytes(mask)


WRITABLE = _writable()
CONFIGURATION_ONLY = frozenset(
    [address + k for address in (*FILTER_ADDRESSES, *MASK_ADDRESSES) for k in range(4)]
    + [CNF1, CNF2, CNF3, TXRTSCTRL]
)
"""Written in configuration mode only; filters and masks read as 0 in any other."""
HIDDEN = CONFIGURATION_ONLY - {CNF1, CNF2, CNF3, TXRTSCTRL}
BIT_MODIFIABLE = frozenset(
    [BFPCTRL, TXRTSCTRL, CANCTRL, CNF1, CNF2, CNF3, CANINTE, CANINTF, EFLG, *TXBCTRL, *RXBCTRL]
)
"""BIT MODIFY anywhere else writes the whole byte. Addresses here and in WRITABLE are canonical."""


def canonical(address: int) -> int:
    """Where a mirrored register really is."""
    address &= SIZE - 1
    return address & 0x0F if address & 0x0E == 0x0E else address


def error_flags(tec: int, rec: int, *, bus_off: bool) -> int:
    """Bits 0..5 of EFLG."""
    flags = 0
    if rec >= WARNING_AT:
        flags |= RXWAR | EWARN
    if tec >= WARNING_AT:
        flags |= TXWAR | EWARN
    if rec > PASSIVE_ABOVE:
        flags |= RXEP
    if tec > PASSIVE_ABOVE:
        flags |= TXEP
    if bus_off:
        flags |= TXBO
    return flags
