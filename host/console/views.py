"""What the consoles are shown of the bus: whoever serves them fills it in.

How they look: red on black for a dark observatory floor, dark on light by day (theme.css).
"""

from concurrent.futures import Future
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, Protocol

from bus.protocol.nodes import DEVICES, documented

if TYPE_CHECKING:
    from cantools.database import Database

CSS = Path(__file__).with_name("theme.css").read_text(encoding="utf-8")
INK = {"night": "#ff6a5a", "day": "#0b5cad"}
SOFT = {"night": "#b3463b", "day": "#a85a00"}
LINE = {"night": "#5a1f1a", "day": "#c3cad2"}


KEPT = 25
"""Frames that a page shows."""


class Node(NamedTuple):
    """A node of the CAN bus: error state by ISO 11898-1, counters; its frames' share of the last second."""

    name: str
    powered: bool
    state: str
    tec: int
    rec: int
    load: float = 0.0


class FaultKind(NamedTuple):
    """A fault that can be made: its level (bus, board …) and what happens. Then the arguments it needs as
    `name=` words, and all of its arguments with units and bounds."""

    name: str
    level: str
    text: str
    needed: str
    arguments: str


class BusState(NamedTuple):
    """The wire as it stands. load: share of the last second that the bus was busy, 0..1. errors: error frames
    so far by cause. running: faults that are on, number and a line of words. frames: (end ns, sender,
    identifier, data) of the last ones, newest last."""

    nodes: list[Node]
    load: float
    errors: dict[str, int]
    running: list[tuple[int, str]]
    frames: list[tuple[int, str, int, bytes]]


class BusView(Protocol):
    """The bus as its own emulator or adapter sees it; safe to call from the consoles' thread."""

    boards: tuple[str, ...]
    """Those whose supply can be switched here; empty on a real bus."""
    kinds: list[FaultKind]
    """Faults that can be made; empty on a real bus."""

    def look(self) -> BusState:
        """Everything at this moment; nodes in the order they joined."""

    def wish(self, command: str) -> Future[str]:
        """Have a command of the control plane (`power`, `fault`) carried out with the next slice of time: its
        answer, or ValueError with one line."""


@cache
def _protocol() -> "Database":
    """Of all boards that come along; a network has some of them."""
    return documented(DEVICES)


def words(identifier: int, data: bytes) -> str:
    """Signals of a frame; its device is the sender's column already."""
    try:
        said = _protocol().decode_message(identifier, data)
    except Exception:  # whatever anybody put on the bus is shown as it is
        return "not in the protocol"
    pairs = said.items() if isinstance(said, dict) else ()
    return ", ".join(f"{name} {_short(value)}" for name, value in pairs if name != "Device")


def _short(value: object) -> object:
    """A scaled signal without the digits that its binary form adds."""
    return f"{value:.10g}" if isinstance(value, float) else value
