"""EFLG from the error counters (DS20001801 section 6 and register 6-3)."""

from boards.chips.mcp2515.registers import (
    EWARN,
    PASSIVE_ABOVE,
    RXEP,
    RXWAR,
    TXBO,
    TXEP,
    TXWAR,
    WARNING_AT,
)  # fmt: skip


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
