"""A served network in a file, and on from it: `schmidt control snapshot NAME`, `schmidt serve --from FILE`.

What stands in it is what the queue drives: boards, bus, frames in flight and waiting at a door, USB reports
under way, faults, plant. What lives in real time does not: doors with their clients, the host program in its
own process (sockets, threads and generators), what is recorded.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from bus.can.candump import CandumpWriter
from bus.door import Door as Fence
from bus.errorframes import ErrorFrames
from bus.node import OutsideNode
from bus.pacer import Pacer
from bus.punctual import Punctuality
from host.serial_link import SerialLink
from plant.model import PlantModel
from scenarios.doors.busview import EmulatedBus
from scenarios.doors.debug_pty import DebugFeed
from scenarios.doors.entry import Entry
from scenarios.doors.lines import Feed
from scenarios.doors.usb import Usb, UsbPlug
from scenarios.faults import Faults
from scenarios.model import Scenario
from scenarios.network import Network
from scenarios.recorder import Recorder
from scenarios.session import SERIAL
from scenarios.snapshot.freeze import restore, take
from scenarios.snapshot.outside import Nobody, nothing

if TYPE_CHECKING:
    from scenarios.doors.served import Served

_OUTSIDERS = (
    CandumpWriter, DebugFeed, EmulatedBus, Entry, ErrorFrames, Feed, Fence, Pacer, Punctuality, Recorder,
    SerialLink, UsbPlug,
)  # fmt: skip
"""Whoever hangs on a served network and is not of it."""
_OF_A_RUN = ("session", "can", "recorder", "usb", "truth", *(device.name for device in SERIAL))
"""What the snapshot of a run names as outside of it (`snapshot/run.py`)."""


@dataclass
class Standing:
    """A network as it stood. entries: how many inputs the session had had; nodes: of the doors to CAN, by
    their kinds of entry; usb: the cable with what is on it."""

    scenario: Scenario
    model: PlantModel
    network: Network
    faults: Faults
    entries: int = 0
    usb: Usb | None = None
    nodes: dict[str, OutsideNode] = field(default_factory=dict)


def whole(served: Served) -> dict[str, Any]:
    """What goes into the file, between two slices; raises SnapshotError."""
    inner = (served.network, served.faults, served.usb, served.nodes)
    return {
        "kind": "served",
        "scenario": served.scenario,
        "model": served.model,
        "entries": served.entry.count,
        "network": take(inner, outsiders=_OUTSIDERS),
    }


def standing(found: dict[str, Any]) -> Standing:
    """The network of what `read` has found: of a served session, or of a run at its instant.

    Nobody listens to it. Raises SnapshotError.
    """
    network, faults, *more = restore(found["network"], dict.fromkeys(_OF_A_RUN, Nobody()))
    made = Standing(found["scenario"], found["model"], network, faults)
    if found.get("kind") == "served":
        made.entries = found["entries"]
        made.usb, made.nodes = more
    _silence(made)
    return made


def _silence(made: Standing) -> None:
    network = made.network
    network.wire._taps[:] = [tap for tap in network.wire._taps if tap is not nothing]
    network.plant.record(None)
    network.hid.to_host = None
    for uart in network.uarts.values():
        uart.sink = uart.line = None
    for port in network.debug.values():
        port.sink = None
    for node in made.nodes.values():
        node.port.on_receive = node.port.on_error = None
