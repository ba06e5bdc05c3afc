"""POSITION (5 ms), SUMMARY (250 ms) of a position board; TARGET (250 ms): what an axis is heading for."""

from enum import IntFlag
from struct import Struct, error
from typing import Final, NamedTuple

from bus.protocol.names import SUMMARY_KIND
from bus.protocol.saturate import Clip, fitted, nobody

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


_target: Final = Struct("<BBBix")


class Target(NamedTuple):
    """speed_class: SpeedClass; settled: 0 or 1; distance: to go, steps of the position encoder."""

    device: int
    speed_class: int
    settled: int
    distance: int


def pack_target(device: int, speed_class: int, settled: int, distance: int, clip: Clip = nobody) -> bytes:
    """Eight bytes of TARGET; a distance that does not fit is cut, and `clip` told."""
    try:
        return _target.pack(device, SUMMARY_KIND, speed_class | settled << 4, distance)
    except error:
        clip()
        return _target.pack(*fitted(_target, (device, SUMMARY_KIND, speed_class | settled << 4, distance)))


def unpack_target(data: bytes) -> Target:
    """The signals of eight bytes of TARGET."""
    device, _, packed, distance = _target.unpack(data)
    return Target(device, packed & 0xF, packed >> 4, distance)
