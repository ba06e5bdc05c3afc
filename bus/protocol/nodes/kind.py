"""What a kind of board says of itself on the bus, in one place; identifiers and common frames follow."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from bus.protocol.names import DECLARED, Device, declared_device

_LAST_TYPE = 0x7F
"""Device types have seven bits."""


class KindError(ValueError):
    """A declaration that cannot stand beside the others."""


@dataclass(frozen=True, slots=True)
class ParameterRow:
    """One parameter: number on the wire, name with its unit, bounds (inclusive) and value after power-up."""

    number: int
    name: str
    low: int
    high: int
    default: int


@dataclass(frozen=True)
class Kind:
    """A kind of board. name: in capitals, without an underscore. nodes: device type by board name.

    dbc: its own frames, written for device type 0: 512 is 0x200 + the type. COMMAND (128) is needed only for
        opcodes of its own; byte 0, PING, parameters, REPLY and HEARTBEAT are added.
    """

    name: str
    nodes: Mapping[str, int]
    dbc: Path
    parameters: tuple[ParameterRow, ...] = ()

    def __hash__(self) -> int:
        return hash(self.name)


_kinds: dict[str, Kind] = {}
_by_type: dict[int, Kind] = {}


def declare(kind: Kind) -> tuple[Device, ...]:
    """Make a kind known, so that `Device(number)` finds its boards; the same one twice changes nothing.

    Raises KindError for names and device types that are taken or cannot be.
    """
    if _kinds.get(kind.name) == kind:
        return tuple(Device(number) for number in kind.nodes.values())
    if kind.name in _kinds:
        raise KindError(f"board kind {kind.name}: declared twice, and differently")
    if not kind.name.isalnum() or kind.name != kind.name.upper():
        raise KindError(f"board kind {kind.name!r}: a name is capitals and digits")
    names = {device.name for device in [*Device, *DECLARED.values()]}
    for name, number in kind.nodes.items():
        if name.partition("_")[0] != kind.name:
            raise KindError(
                f"board {name}: boards of kind {kind.name} are called {kind.name} or {kind.name}_…"
            )
        if not 0 < number <= _LAST_TYPE:
            raise KindError(f"board {name}: device type {number:#04x} is not within 0x01..{_LAST_TYPE:#04x}")
        taken = next((device.name for device in Device if device == number), None) or DECLARED.get(number)
        if taken is not None or name in names:
            raise KindError(f"board {name}: name or device type {number:#04x} is taken")
    _kinds[kind.name] = kind
    for number in kind.nodes.values():
        _by_type[number] = kind
    return tuple(declared_device(name, number) for name, number in kind.nodes.items())


def declared_kinds() -> tuple[Kind, ...]:
    """All kinds so far, in the order of their declaration."""
    return tuple(_kinds.values())


def kind_of(device: int) -> Kind | None:
    """The kind of a device type; None: a board written by hand, or nobody."""
    return _by_type.get(device)
