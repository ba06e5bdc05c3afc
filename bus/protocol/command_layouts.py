"""COMMAND: a table of one layout per opcode; byte 0 is the device type, byte 1 the opcode, the rest below."""

from functools import cache
from struct import Struct, error
from typing import Final

from bus.protocol.names import Device, Opcode

LAYOUTS: dict[int, tuple[Struct, tuple[str, ...]]] = {
    Opcode.PING: (Struct("<6x"), ()),
    Opcode.GET_PARAMETER: (Struct("<B5x"), ("parameter",)),
    Opcode.SET_PARAMETER: (Struct("<Bix"), ("parameter", "value")),
    Opcode.POWER: (Struct("<B5x"), ("on",)),
    Opcode.STOP: (Struct("<6x"), ()),
    Opcode.SET_RATE: (Struct("<i2x"), ("rate",)),
    Opcode.SET_CLASS: (Struct("<Bb4x"), ("speed_class", "direction")),
    Opcode.MOVE_TO: (Struct("<IBx"), ("target", "speed_class")),
    Opcode.TRACK_RATE: (Struct("<i2x"), ("rate",)),
    Opcode.OPEN_LOOP: (Struct("<h4x"), ("effort",)),
    Opcode.NUDGE: (Struct("<i2x"), ("offset",)),
    Opcode.FOCUS_STEP: (Struct("<b5x"), ("steps",)),
    Opcode.FOCUS_MOVE_TO: (Struct("<h4x"), ("target",)),
    Opcode.FOCUS_HOLD: (Struct("<6x"), ()),
    Opcode.FOCUS_FREE: (Struct("<6x"), ()),
    Opcode.FOCUS_REFERENCE: (Struct("<6x"), ()),
    Opcode.BRIGHTNESS: (Struct("<B5x"), ("percent",)),
}
"""Opcode -> layout of bytes 2..7 and the names of its arguments. Units: rate Q16 counts per 5 ms, target
and offset steps of the position encoder (half steps for the focus), effort 1/3000 of the supply."""

_COMMON: Final = (Opcode.PING, Opcode.GET_PARAMETER, Opcode.SET_PARAMETER)
_AXIS: Final = tuple(Opcode(number) for number in range(Opcode.POWER, Opcode.NUDGE + 1))
_FOCUS: Final = tuple(Opcode(number) for number in range(Opcode.FOCUS_STEP, Opcode.FOCUS_REFERENCE + 1))


class CommandError(ValueError):
    """A command the protocol cannot carry."""


def opcodes(device: Device) -> tuple[Opcode, ...]:
    """Opcodes `device` knows."""
    match device:
        case Device.AXIS_RA | Device.AXIS_DEC:
            return _COMMON + _AXIS
        case Device.FOCUS:
            return _COMMON + _FOCUS
        case Device.DISPLAY:
            return (*_COMMON, Opcode.BRIGHTNESS)
    return _COMMON


def layout_of(opcode: int) -> tuple[Struct, tuple[str, ...]]:
    """Layout of bytes 2..7 and the names of its arguments, a declared board's opcode's, too.

    Raises CommandError for a number that is no opcode.
    """
    if isinstance(opcode, Opcode) and opcode.declared is not None:
        return _declared(*opcode.declared)
    try:
        return LAYOUTS[opcode]
    except KeyError:
        raise CommandError(f"opcode {opcode:#04x} is not in the protocol") from None


@cache
def _declared(layout: str, names: tuple[str, ...]) -> tuple[Struct, tuple[str, ...]]:
    return Struct(layout), names


def pack_command(device: int, opcode: int, *arguments: int) -> bytes:
    """Eight bytes of COMMAND; raises CommandError for arguments that do not fit the opcode's layout."""
    layout, names = layout_of(opcode)
    try:
        return bytes((device, opcode)) + layout.pack(*arguments)
    except error as reason:
        wanted = ", ".join(names) or "no arguments"
        name = opcode.name if isinstance(opcode, Opcode) else Opcode(opcode).name
        raise CommandError(f"{name} takes {wanted}; {arguments} does not fit: {reason}") from None


def unpack_command(data: bytes) -> tuple[int, int, tuple[int, ...]]:
    """Device type, opcode and arguments; raises CommandError for an unknown opcode or a wrong length."""
    if len(data) != 8 or data[1] not in LAYOUTS:
        raise CommandError(f"not a command of the protocol: {data.hex(' ')}")
    return data[0], data[1], LAYOUTS[data[1]][0].unpack_from(data, 2)
