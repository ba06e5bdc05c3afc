"""HEARTBEAT: every board's sign of life, every second."""

from struct import Struct
from typing import Final, NamedTuple

from bus.protocol.names import HEARTBEAT_KIND

_heartbeat: Final = Struct("<BBBHHB")


class Heartbeat(NamedTuple):
    """state: State; uptime: s, wraps after 65 536; overruns: lost interrupts, stays at 65 535; tec:
    0..255."""

    device: int
    state: int
    uptime: int
    overruns: int
    tec: int


def pack_heartbeat(device: int, state: int, uptime: int, overruns: int, tec: int) -> bytes:
    """Eight bytes; uptime wraps, overruns and tec stay at their largest value."""
    return _heartbeat.pack(
        device, HEARTBEAT_KIND, state, uptime & 0xFFFF, min(overruns, 0xFFFF), min(tec, 0xFF)
    )


def unpack_heartbeat(data: bytes) -> Heartbeat:
    """The signals of eight bytes of HEARTBEAT."""
    device, _, state, uptime, overruns, tec = _heartbeat.unpack(data)
    return Heartbeat(device, state, uptime, overruns, tec)
