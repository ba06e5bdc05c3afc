"""REPLY: the one answer to each COMMAND."""

from struct import Struct
from typing import Final, NamedTuple

_reply: Final = Struct("<BBBBi")


class Reply(NamedTuple):
    """opcode: the command's (0 when it was too short to have one); result: Result; value: by opcode, see
    schmidt.dbc."""

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
