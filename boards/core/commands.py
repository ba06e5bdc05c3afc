"""Command dispatch: opcode to handler, and exactly one reply for each command, whatever is wrong with it."""

from collections.abc import Callable, Mapping

from boards.core.results import Answer
from bus.protocol import FRAME_BYTES, Result

Handler = Callable[[int, bytes], Answer]
"""(t_ns, the six bytes after device type and opcode) -> reply."""


def answer(device_type: int, table: Mapping[int, Handler], t_ns: int, data: bytes) -> tuple[int, Answer]:
    """Check and run one command; returns its opcode (0 when the frame is too short to have one) and the
    reply."""
    opcode = data[1] if len(data) > 1 else 0
    if len(data) != FRAME_BYTES:
        return opcode, Answer(Result.WRONG_LENGTH)
    if data[0] != device_type:
        return opcode, Answer(Result.WRONG_DEVICE_TYPE)
    handler = table.get(opcode)
    if handler is None:
        return opcode, Answer(Result.UNKNOWN_OPCODE)
    return opcode, handler(t_ns, data[2:])


def u8(data: bytes, offset: int = 0) -> int:
    """Unsigned byte of a command's arguments."""
    return data[offset]


def i8(data: bytes, offset: int = 0) -> int:
    """Signed byte of a command's arguments."""
    return int.from_bytes(data[offset : offset + 1], "little", signed=True)


def i16(data: bytes, offset: int = 0) -> int:
    """Signed 16-bit argument."""
    return int.from_bytes(data[offset : offset + 2], "little", signed=True)


def i32(data: bytes, offset: int = 0) -> int:
    """Signed 32-bit argument."""
    return int.from_bytes(data[offset : offset + 4], "little", signed=True)


def u32(data: bytes, offset: int = 0) -> int:
    """Unsigned 32-bit argument."""
    return int.from_bytes(data[offset : offset + 4], "little")
