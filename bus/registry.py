"""Wires of this process by name, so that `can.Bus(interface="schmidt", channel=NAME)` finds them."""

from bus.can.wire import MAX_BITRATE, Wire
from bus.time import EventQueue

_wires: dict[str, Wire] = {}


class NameTakenError(ValueError):
    """Another wire already has this name."""


def publish(name: str, wire: Wire) -> None:
    """Let `wire` be opened as channel `name`; raises NameTakenError when another wire has it."""
    if _wires.setdefault(name, wire) is not wire:
        raise NameTakenError(f'channel "{name}" is already published in this process; withdraw it first')


def withdraw(name: str) -> None:
    """Forget the name; nodes already on the wire stay there."""
    _wires.pop(name, None)


def named(name: str, bitrate: int = MAX_BITRATE) -> Wire:
    """The wire called `name`; made with an event queue of its own when there is none yet."""
    if name not in _wires:
        _wires[name] = Wire(EventQueue(), bitrate)
    return _wires[name]
