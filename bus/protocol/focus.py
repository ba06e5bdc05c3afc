"""FOCUS: the focus board's measurement frame, every 50 ms."""

from enum import IntFlag
from struct import Struct
from typing import NamedTuple

_focus = Struct("<BBhhH")


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


def pack_focus(device: int, flags: int, position: int, encoder: int, lvdt: int) -> bytes:
    """Eight bytes of FOCUS."""
    return _focus.pack(device, flags, position, encoder, lvdt)


def unpack_focus(data: bytes) -> Focus:
    """The signals of eight bytes of FOCUS."""
    return Focus._make(_focus.unpack(data))
