"""FOCUS: the focus board's measurement frame, every 50 ms."""

from enum import IntFlag
from struct import Struct, error
from typing import Final, NamedTuple

from bus.protocol.saturate import Clip, fitted, nobody

_focus: Final = Struct("<BBhhH")


class FocusFlag(IntFlag):
    """Flag byte of FOCUS."""

    MOVING = 1
    REFERENCED = 2
    HOLD = 4
    FREE = 8
    INDEX_SEEN = 16


class Focus(NamedTuple):
    """position: half steps; encoder: counts; lvdt: 10-bit counts."""

    device: int
    flags: int
    position: int
    encoder: int
    lvdt: int


def pack_focus(device: int, flags: int, position: int, encoder: int, lvdt: int, clip: Clip = nobody) -> bytes:
    """Eight bytes of FOCUS; what does not fit is cut, and `clip` told."""
    try:
        return _focus.pack(device, flags, position, encoder, lvdt)
    except error:
        clip()
        return _focus.pack(*fitted(_focus, (device, flags, position, encoder, lvdt)))


def unpack_focus(data: bytes) -> Focus:
    """The signals of eight bytes of FOCUS."""
    return Focus._make(_focus.unpack(data))
