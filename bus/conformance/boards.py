"""Who is checked: a board of the protocol, or one of a known type under an identifier of its own."""

from collections.abc import Sequence
from typing import NamedTuple

from bus.protocol import Device
from bus.protocol.nodes import DEVICES

_IDENTIFIERS = 0x80
"""Device types are seven bits: an identifier is a base plus a device type."""


class BoardError(ValueError):
    """A board that cannot be checked."""


class Board(NamedTuple):
    """name: in reports. family: its type, the first word of its model's name. device: its device type.

    model: a board of the same type in the DBC, whose frames are documented.
    """

    name: str
    family: str
    device: int
    model: Device


def family_of(device: Device) -> str:
    """`AXIS` of AXIS_RA."""
    return device.name.partition("_")[0]


def board_of(device: Device) -> Board:
    """A board of the protocol."""
    return Board(device.name, family_of(device), int(device), device)


def parse(text: str, known: Sequence[Device] = DEVICES) -> Board:
    """`TYPE:ID`, such as axis:0x11, of a type that is `known`; raises BoardError with one line."""
    kind, colon, number = text.partition(":")
    models = {family_of(each).lower(): each for each in reversed(known)}
    if not colon:
        raise BoardError(f'--board "{text}": expected TYPE:ID, such as axis:0x11')
    if kind.lower() not in models:
        raise BoardError(f'--board "{text}": no type "{kind}"; expected {", ".join(sorted(models))}')
    try:
        device = int(number, 0)
    except ValueError:
        raise BoardError(f'--board "{text}": "{number}" is not a number such as 0x11') from None
    if not 0 < device < _IDENTIFIERS:
        raise BoardError(f'--board "{text}": a device type is 1 to 0x7f, not {number}')
    own = next((each for each in known if each == device), None)
    if own is not None and family_of(own).lower() == kind.lower():
        return board_of(own)
    return Board(f"{kind.upper()}:{device:#04x}", kind.upper(), device, models[kind.lower()])
