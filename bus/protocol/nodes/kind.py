"""What a kind of board says of itself on the bus, in one place; identifiers and common frames follow.

The kinds are of the boards that only the network `final` has (B8, P10, P13). Everything of them is an
ASSUMPTION: the paper names the boards and nothing more. Device types 0x23, 0x24 and 0x71..0x73 were reserved
for them. That weather and power come twice makes the network the paper's "over sixteen".
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from bus.protocol.names import Device

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

    def device(self, name: str) -> Device:
        """One of its boards."""
        return Device.further(name, self.nodes[name], self)

    def devices(self) -> tuple[Device, ...]:
        """All of its boards."""
        return tuple(self.device(name) for name in self.nodes)


def kind_of(device: Device) -> Kind | None:
    """The kind of a declared board; None: one that is written by hand."""
    kind: Kind | None = device.declared
    return kind


def check_kind(kind: Kind, beside: Iterable[Kind]) -> None:
    """Raises KindError for names and device types that cannot be, or that the lab's boards or another of
    `beside` have. The same kind twice is one."""
    if not kind.name.isalnum() or kind.name != kind.name.upper():
        raise KindError(f"board kind {kind.name!r}: a name is capitals and digits, without an underscore")
    others = [each for each in beside if each != kind]
    if kind.name in {each.name for each in others}:
        raise KindError(f"board kind {kind.name}: declared twice, and differently")
    taken = [*Device, *(device for each in others for device in each.devices())]
    for device in kind.devices():
        name, number = device.name, int(device)
        if name.partition("_")[0] != kind.name:
            raise KindError(
                f"board {name}: boards of kind {kind.name} are called {kind.name} or {kind.name}_…"
            )
        if not 0 < number <= _LAST_TYPE:
            raise KindError(f"board {name}: device type {number:#04x} is not within 0x01..{_LAST_TYPE:#04x}")
        if any(name == each.name or number == each for each in taken):
            raise KindError(f"board {name}: name or device type {number:#04x} is taken")


_FILE = Path(__file__).with_name("kinds.yaml")


def _kind(name: str, row: dict[str, Any]) -> Kind:
    parameters = (ParameterRow(number, *said) for number, said in row.get("parameters", {}).items())
    return Kind(name, row["nodes"], _FILE.with_name(f"{name.lower()}.dbc"), tuple(parameters))


KINDS = tuple(_kind(*row) for row in yaml.safe_load(_FILE.read_text(encoding="utf-8")).items())
AUXILIARY, DOME, WEATHER, POWER, *_ = KINDS
DEVICES = (*Device, *(device for kind in KINDS for device in kind.devices()))
"""All boards that come along, the lab's first."""
