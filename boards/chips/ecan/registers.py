"""Registers of the PIC18F4480's ECAN in mode 0 (legacy) as a table (DS39637, section 23; K unless marked).

PIR3 and PIE3 have the bits of CANINTF in its order (RXB0IF, RXB1IF, TXB0IF to TXB2IF, ERRIF, WAKIF, IRXIF).
Mode 0 is the logic of the stand-alone controller under other names. So each register names the one it is
there (address of the MCP2515). Its own bits stand below.
"""

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
