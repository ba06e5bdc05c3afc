"""A served network in a file, and on from it: `schmidt control snapshot NAME`, `schmidt serve --from FILE`.

What stands in it is what the queue drives: boards, bus, frames in flight and waiting at a door, USB reports
under way, faults, plant. What lives in real time does not: doors with their clients, the host program in its
own process (sockets, threads and generators), what is recorded.
"""

from dataclasses import dataclass, field
from typing import Any

from bus.outside.node import OutsideNode
from plant.model import PlantModel
from scenarios.doors.usb import Usb
from scenarios.lab.faults import Faults
from scenarios.lab.network import Network
from scenarios.lab.networks import SERIAL
from scenarios.lab.snapshot.freeze import restore
from scenarios.lab.snapshot.outside import Nobody, nothing
from scenarios.language.model import Scenario

_OF_A_RUN = ("session", "can", "recorder", "usb", "truth", "chain", *(device.name for device in SERIAL))
"""What the snapshot of a run names as outside of it (`snapshot/run.py`)."""


@dataclass(frozen=True, kw_only=True)
class Standing:
    """A network as it stood. entries: how many inputs the session had had. nodes: of the doors to CAN, by
    their kinds of entry. usb: the cable with what is on it."""

    scenario: Scenario
    model: PlantModel
    network: Network
    faults: Faults
    entries: int = 0
    usb: Usb | None = None
    nodes: dict[str, OutsideNode] = field(default_factory=dict)


def standing(found: dict[str, Any]) -> Standing:
    """The network of what `read` has found: of a served session, or of a run at its instant.

    Nobody listens to it. Raises SnapshotError.
    """
    network, faults, *more = restore(found["network"], dict.fromkeys(_OF_A_RUN, Nobody()))
    usb, nodes = more if found.get("kind") == "served" else (None, {})
    made = Standing(
        scenario=found["scenario"],
        model=found["model"],
        network=network,
        faults=faults,
        entries=found.get("entries", 0),
        usb=usb,
        nodes=nodes,
    )
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
