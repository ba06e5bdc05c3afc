"""Integers as wide as registers: Python's never overflow, a controller's do.

C on the dsPIC30F and the PIC18 has 16, 32 and 64 bit; 64-bit products and quotients are library calls.
Whatever a board accumulates has one of these widths. It fits for every parameter and input that is accepted
(the tests compute with integers that complain). Otherwise it saturates (the firmware compares) or wraps
(counters). Times are 64-bit nanoseconds and ticks are 32 bits, 248 days of 5 ms. The focus' half steps are 32
bits: a search for the index that fails adds 440, so 73 days of failing searches fit.
"""

from typing import Final

INT32_TOP: Final = (1 << 31) - 1
INT64_TOP: Final = (1 << 63) - 1


def saturate(value: int, top: int) -> int:
    """`value` within -top..top; symmetric, so that a sign can always be turned."""
    return top if value > top else -top if value < -top else value
