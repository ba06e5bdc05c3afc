"""A CAN frame in the journal of a served session: identifier u32, flags u8 (1 extended, 2 remote), data."""

from struct import Struct

from bus.can.frame import Frame

_head = Struct("<IB")
_EXTENDED, _REMOTE = 1, 2


def pack_frame(frame: Frame) -> bytes:
    """5 to 13 bytes."""
    return _head.pack(frame.identifier, _EXTENDED * frame.extended | _REMOTE * frame.remote) + frame.data


def unpack_frame(data: bytes) -> Frame:
    """The frame of such bytes."""
    identifier, flags = _head.unpack_from(data)
    return Frame(identifier, data[_head.size :], bool(flags & _EXTENDED), bool(flags & _REMOTE))
