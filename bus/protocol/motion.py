"""MOTION: an axis board's measurement frame, every 10 ms."""

from enum import IntFlag
from typing import NamedTuple

from bus.protocol.saturate import Clip, nobody
from bus.protocol.signed import SIGN_13, SIGN_15


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
