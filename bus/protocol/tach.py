"""TACH: a motor velocity board's measurement frame, every 10 ms."""

from struct import Struct, error
from typing import Final, NamedTuple

from bus.protocol.saturate import fitted

_tach: Final = Struct("<BBih")
tach_fields: Final = _tach.unpack
"""The signals of eight bytes as a plain tuple, for receivers that take thousands."""


class Tach(NamedTuple):
    """counts: free running, 4096 per motor turn, wraps at 32 bit; delta: counts in 10 ms; flags: none
    defined yet."""

    device: int
    flags: int
    counts: int
    delta: int


def pack_tach(device: int, flags: int, counts: int, delta: int) -> bytes:
    """Eight bytes; `counts` wraps at 32 bits (it runs free), a `delta` beyond 16 is cut to the largest."""
    counts = ((counts + 0x8000_0000) & 0xFFFF_FFFF) - 0x8000_0000
    try:
        return _tach.pack(device, flags, counts, delta)
    except error:
        return _tach.pack(*fitted(_tach, (device, flags, counts, delta)))


def unpack_tach(data: bytes) -> Tach:
    """The signals of eight bytes."""
    return Tach._make(_tach.unpack(data))
