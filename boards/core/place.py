"""Where a board is put: what every one of them is given, whatever it does."""

from dataclasses import dataclass

from bus.can import Wire
from bus.time import EventQueue, Oscillator


@dataclass(frozen=True, kw_only=True)
class Place:
    """name: of the board and its node. device_type: 0x01..0x7f. queue: simulation time. wire: its CAN bus.
    oscillator: its crystal."""

    name: str
    device_type: int
    queue: EventQueue
    wire: Wire
    oscillator: Oscillator
