"""TARGET: what an axis board is heading for, every 250 ms."""

from struct import Struct, error
from typing import Final, NamedTuple

from bus.protocol.names import SUMMARY_KIND
from bus.protocol.saturate import Clip, fitted, nobody

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
