"""MOTION of an axis and TACH of a motor, every 10 ms; FOCUS, every 50 ms: measurement frames."""

from enum import IntFlag
from struct import Struct, error
from typing import Final, NamedTuple

from bus.protocol.saturate import Clip, fitted, nobody

SIGN_13: Final = 1 << 12
SIGN_15: Final = 1 << 14


class MotionFlag(IntFlag):
    """Flag nibble of MOTION."""

    MOVING = 1
    SOFT_LIMIT = 2
    FAULT = 4
    POWERED = 8


class Motion(NamedTuple):
    """velocity: counts in the last 5 ms; effort: 1/3000 of the supply; adc_a, adc_b: 10-bit counts."""

    device: int
    mode: int
    flags: int
    velocity: int
    effort: int
    adc_a: int
    adc_b: int


def pack_motion(
    device: int, status: int, velocity: int, effort: int, adcs: tuple[int, int], clip: Clip = nobody
) -> bytes:
    """Eight bytes; a velocity beyond 15 bits or an effort beyond 13 is cut, and `clip` told.

    status: the mode, and the flags times 16. adcs: 10-bit counts of both motors.
    """
    if not (-SIGN_15 <= velocity < SIGN_15 and -SIGN_13 <= effort < SIGN_13):
        clip()
        velocity = min(max(velocity, -SIGN_15), SIGN_15 - 1)
        effort = min(max(effort, -SIGN_13), SIGN_13 - 1)
    return (
        device
        | status << 8
        | (velocity & 0x7FFF) << 16
        | (effort & 0x1FFF) << 31
        | adcs[0] << 44
        | adcs[1] << 54
    ).to_bytes(8, "little")


def unpack_motion(data: bytes) -> Motion:
    """The signals of eight bytes."""
    word = int.from_bytes(data, "little")
    velocity = word >> 16 & 0x7FFF
    effort = word >> 31 & 0x1FFF
    return Motion(
        word & 0xFF,
        word >> 8 & 0xF,
        word >> 12 & 0xF,
        (velocity ^ SIGN_15) - SIGN_15,
        (effort ^ SIGN_13) - SIGN_13,
        word >> 44 & 0x3FF,
        word >> 54,
    )


_tach: Final = Struct("<BBih")
tach_fields: Final = _tach.unpack
"""The signals of eight bytes as a plain tuple, for receivers that take thousands."""


class Tach(NamedTuple):
    """counts: free running, 4096 per motor turn, wraps at 32 bit; delta: counts in 10 ms; flags: none yet."""

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
