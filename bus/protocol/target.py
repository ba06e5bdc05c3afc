"""TARGET: what an axis board is heading for, every 250 ms."""

from struct import Struct
from typing import NamedTuple

from bus.protocol.names import SUMMARY_KIND

_target = Struct("<BBBix")


class Target(NamedTuple):
    """speed_class: SpeedClass; settled: 0 or 1; distance: to go, steps of the position encoder."""

    device: int
    speed_class: int
    settled: int
    distance: int


def pack_target(device: int, speed_class: int, settled: int, distance: int) -> bytes:
    """Eight bytes of TARGET."""
    return _target.pack(device, SUMMARY_KIND, speed_class | settled << 4, distance)


def unpack_target(data: bytes) -> Target:
    """The signals of eight bytes of TARGET."""
    device, _, packed, distance = _target.unpack(data)
    return Target(device, packed & 0xF, packed >> 4, distance)
