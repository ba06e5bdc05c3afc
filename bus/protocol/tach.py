"""TACH: a motor velocity board's measurement frame, every 10 ms."""

from struct import Struct
from typing import Final, NamedTuple

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
    """Eight bytes; `counts` wraps at 32 bits (it runs free), `delta` is of a 16-bit counter."""
    word = device | flags << 8 | (counts & 0xFFFF_FFFF) << 16 | (delta & 0xFFFF) << 48
    return word.to_bytes(8, "little")


def unpack_tach(data: bytes) -> Tach:
    """The signals of eight bytes."""
    return Tach._make(_tach.unpack(data))
