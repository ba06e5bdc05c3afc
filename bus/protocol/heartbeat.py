"""HEARTBEAT: every board's sign of life, every second. REPLY: its one answer to each COMMAND."""

from struct import Struct
from typing import Final, NamedTuple

from bus.protocol.names import HEARTBEAT_KIND

_heartbeat: Final = Struct("<BBBHHB")


class Heartbeat(NamedTuple):
    """state: State; uptime: s, wraps at 65 536; overruns: lost interrupts, stays at 65 535; tec: 0..255."""

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


_reply: Final = Struct("<BBBBi")


class Reply(NamedTuple):
    """opcode: the command's (0: too short to have one); result: Result; value: by opcode, see schmidt.dbc."""

    device: int
    opcode: int
    result: int
    parameter: int
    value: int


def pack_reply(device: int, opcode: int, result: int, parameter: int, value: int) -> bytes:
    """Eight bytes of REPLY."""
    return _reply.pack(device, opcode, result, parameter, value)


def unpack_reply(data: bytes) -> Reply:
    """The signals of eight bytes of REPLY."""
    return Reply._make(_reply.unpack(data))
