"""Quadrature encoder interface: a 16-bit position counter that nobody but the encoder touches.

dsPIC30F3011 with QEIM = 111 and MAXCNT = 0xFFFF, PIC18F4431 with MAXCNT = 0xFFFF: the counter wraps freely
(hardware.md 3.4, 3.5). So firmware may use differences modulo 65536 and nothing else.
"""

from collections.abc import Callable
from typing import Final

_MASK: Final = 0xFFFF


class Qei:
    """pin: the encoder, (t_ns) -> counts after quadrature, any int. A stuck sensor is another callable."""

    def __init__(self, pin: Callable[[int], int]) -> None:
        self.pin = pin

    def poscnt(self, t_ns: int) -> int:
        """Register POSCNT at `t_ns`, 0..65535."""
        return self.pin(t_ns) & _MASK


def difference(now: int, before: int) -> int:
    """Counts between two POSCNT readings, signed, right while fewer than 32768 lie between them."""
    return ((now - before + 0x8000) & _MASK) - 0x8000
