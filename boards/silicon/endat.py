"""EnDat 2.2 position transfer, both ends: the encoder makes frames, the master checks them.

Frame after the start bit, in transmission order: F1 (error, active high), F2 (active low), position
LSB first, CRC-5 MSB first (hardware.md 3.1). The whole frame is one integer here, first bit lowest;
the CRC sits on top as the number its five bits spell.
"""

from collections.abc import Callable
from typing import Final

_POLYNOMIAL = 0x0B
"""CRC-5: x^5 + x^3 + x + 1, without its top bit; start value and result inverted (hardware.md 3.1)."""
_INVERT = 0x1F


def crc5(bits: int, count: int) -> int:
    """CRC of the `count` lowest bits of `bits`, taken lowest first. Published vectors hold it to account."""
    crc = _INVERT
    for k in range(count):
        top = (crc >> 4) ^ (bits >> k & 1)
        crc = (crc << 1) & _INVERT
        if top:
            crc ^= _POLYNOMIAL
    return crc ^ _INVERT


POSITION_BITS: Final = 29
CLOCK_HZ: Final = 1_000_000
"""ASSUMPTION: within the 2 MHz that need no delay compensation."""
_DATA_BITS: Final = POSITION_BITS + 2
_POSITION_MASK: Final = (1 << POSITION_BITS) - 1
_HEALTHY_FLAGS: Final = 0b10
"""F1 = 0 in bit 0, F2 = 1 in bit 1."""
_ALARM_FLAGS: Final = 0b01

COMMAND_CLOCKS: Final = 2 + 6 + 2
"""Two clocks, six mode bits, two clocks turn-round before the encoder may answer."""
CALCULATION_NS: Final = 5_000
"""t_cal, position calculation: <= 5 us assumed, the catalogue value was not found (hardware.md 1.3)."""
RECOVERY_NS: Final = 20_000
"""t_m, 10..30 us (hardware.md 3.1)."""


Reading = tuple[int, bool, bool]
"""What the master makes of a frame: position, alarm, whether the CRC is right. A plain tuple, 200 times a
second."""


class EndatEncoder:
    """The RCN 829's end. pin: (t_ns) -> position, any int; wraps at 29 bits. alarm: it reports an error."""

    def __init__(self, pin: Callable[[int], int]) -> None:
        self.pin = pin
        self.alarm = False

    def transfer(self, latch_ns: int) -> int:
        """The frame for a position latched at `latch_ns`: 31 data bits and the CRC above them."""
        flags = _ALARM_FLAGS if self.alarm else _HEALTHY_FLAGS
        data = (self.pin(latch_ns) & _POSITION_MASK) << 2 | flags
        return data | crc5(data, _DATA_BITS) << _DATA_BITS


class EndatMaster:
    """The board's end: clocks the encoder over a line that may be disturbed.

    line: what the cable does to a frame (int -> int), None for nothing.
    latch_to_data_ns: from the first clock edge, where the position is latched, to the last CRC bit.
    """

    def __init__(self, encoder: EndatEncoder, clock_hz: int = CLOCK_HZ) -> None:
        self.encoder = encoder
        self.line: Callable[[int], int] | None = None
        clocks = COMMAND_CLOCKS + 1 + _DATA_BITS + 5
        self.latch_to_data_ns = CALCULATION_NS + clocks * 1_000_000_000 // clock_hz

    def poll(self, latch_ns: int) -> Reading:
        """One "send position" whose first clock edge is at `latch_ns`."""
        encoder = self.encoder
        if self.line is None:  # what is sent arrives, so the CRC need not be made to be found right
            return encoder.pin(latch_ns) & _POSITION_MASK, encoder.alarm, True
        return check(self.line(encoder.transfer(latch_ns)))


def check(frame: int) -> Reading:
    """Take a received frame apart. F1 and F2 that agree mean an alarm too: one of them is wrong."""
    data = frame & 0x7FFFFFFF
    return data >> 2, data & 3 != _HEALTHY_FLAGS, frame >> _DATA_BITS == crc5(data, _DATA_BITS)
