"""POSITION (5 ms) and SUMMARY (250 ms): what a position board measures."""

from enum import IntFlag
from struct import Struct
from typing import Final, NamedTuple

from bus.protocol.names import SUMMARY_KIND

_position: Final = Struct("<BBIBB")
_summary: Final = Struct("<BBBIx")
_tuple: Final = tuple.__new__
AGE_UNIT_NS: Final = 4000
"""Unit of the age, latch of the encoder to loading of the frame."""


class PositionFlag(IntFlag):
    """Flag byte of POSITION and SUMMARY."""

    ALARM = 1
    WARNING = 2
    CRC_ERROR = 4
    LIMIT_LOW = 8
    LIMIT_HIGH = 16


class Position(NamedTuple):
    """position: steps, 29 bit; age: 4 µs; sequence counts the frames modulo 256."""

    device: int
    flags: int
    position: int
    age: int
    sequence: int


class Summary(NamedTuple):
    """position: steps, 29 bit."""

    device: int
    flags: int
    position: int


def pack_position(device: int, flags: int, position: int, age: int, sequence: int) -> bytes:
    """Eight bytes of POSITION; all fit their fields."""
    return (device | flags << 8 | position << 16 | age << 48 | sequence << 56).to_bytes(8, "little")


def unpack_position(data: bytes) -> Position:
    """The signals of eight bytes of POSITION."""
    return _tuple(Position, _position.unpack(data))


def pack_summary(device: int, flags: int, position: int) -> bytes:
    """Eight bytes of SUMMARY."""
    return _summary.pack(device, SUMMARY_KIND, flags, position)


def unpack_summary(data: bytes) -> Summary:
    """The signals of eight bytes of SUMMARY."""
    device, _, flags, position = _summary.unpack(data)
    return Summary(device, flags, position)
