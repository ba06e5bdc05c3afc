"""A declared kind's own opcodes: layout, names and bounds of their arguments, from its DBC."""

from functools import cache
from typing import NamedTuple

from bus.protocol.names import Opcode
from bus.protocol.nodes.kind import Kind, KindError
from bus.protocol.nodes.messages import command_of, opcode_names

_CODES = {
    (8, False): "B",
    (8, True): "b",
    (16, False): "H",
    (16, True): "h",
    (32, False): "I",
    (32, True): "i",
}
_FIRST, _LAST = 16, 64
"""Arguments lie in bytes 2..7."""


class Argument(NamedTuple):
    """name in lower case; low, high: bounds as they stand on the wire."""

    name: str
    low: int
    high: int


@cache
def arguments_of(kind: Kind) -> dict[Opcode, tuple[Argument, ...]]:
    """Opcodes of the kind's own, as `pack_command` takes them, and their arguments.

    Raises KindError for arguments that are not whole bytes and for an opcode no declared board can have.
    """
    command = command_of(kind)
    found: dict[Opcode, tuple[Argument, ...]] = {}
    own = [] if command is None else command.signals
    for number, name in sorted(opcode_names(command).items()):
        if number < 0x40 or number >= 0x7E:
            raise KindError(f"{kind.dbc}: opcode {number:#04x}: a declared board's own are 0x40..0x7d")
        signals = sorted(
            (each for each in own if each.multiplexer_ids == [number] and "Spare" not in each.name),
            key=lambda signal: signal.start,
        )
        layout, at, arguments = "<", _FIRST, []
        for signal in signals:
            code = _CODES.get((signal.length, signal.is_signed))
            if code is None or signal.start < at or signal.start % 8 or signal.start + signal.length > _LAST:
                raise KindError(
                    f"{kind.dbc}: {signal.name}: an argument is 1, 2 or 4 bytes within bytes 2..7"
                )
            layout += f"{(signal.start - at) // 8}x{code}"
            at = signal.start + signal.length
            low, high = (
                round((each - signal.offset) / signal.scale) for each in (signal.minimum, signal.maximum)
            )
            arguments.append(Argument(signal.name.rpartition("_")[2].lower(), low, high))
        declared = f"{layout}{(_LAST - at) // 8}x", tuple(each.name for each in arguments)
        found[Opcode.further(name, number, declared)] = tuple(arguments)
    return found
