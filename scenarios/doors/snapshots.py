"""A served network in a file, and on from it: `schmidt control snapshot NAME`, `schmidt serve --from FILE`.

What stands in it is what the queue drives: boards, bus, frames in flight and waiting at a door, USB reports
under way, faults, plant. What lives in real time does not: doors with their clients, the host program in its
own process (sockets, threads and generators), what is recorded.
"""

import re
from pathlib import Path
from typing import Any, NamedTuple

from bus.can.candump import CandumpWriter
from bus.outside.door import Door as Fence
from bus.outside.errorframes import ErrorFrames
from bus.outside.node import OutsideNode
from bus.outside.pacer import Pacer, Punctuality
from host.logs.files import LogError, reason
from host.serial_link import SerialLink
from plant.model import PlantModel
from scenarios.doors.busview import EmulatedBus
from scenarios.doors.lines import Feed
from scenarios.doors.livenetwork import Entry, LiveNetwork
from scenarios.doors.recording import Recording
from scenarios.doors.serial_pty import DebugFeed
from scenarios.doors.steps import Steps
from scenarios.doors.usb import Usb, UsbPlug
from scenarios.lab.faults.live import Faults
from scenarios.lab.network import Network
from scenarios.lab.networks import SERIAL
from scenarios.lab.recorder import Recorder
from scenarios.lab.snapshot.code import Nobody, nothing
from scenarios.lab.snapshot.file import write
from scenarios.lab.snapshot.freeze import SnapshotError, restore, take
from scenarios.language.model import Scenario

_OF_A_RUN = ("session", "can", "recorder", "usb", "truth", "chain", *(device.name for device in SERIAL))
"""What the snapshot of a run names as outside of it (`snapshot/run.py`)."""


class Standing(NamedTuple):
    """A network as it stood. entries: how many inputs the session had had. nodes: of the doors to CAN, by
    their kinds of entry. usb: the cable with what is on it."""

    scenario: Scenario
    model: PlantModel
    network: Network
    faults: Faults
    entries: int
    usb: Usb | None
    nodes: dict[str, OutsideNode]


def standing(found: dict[str, Any]) -> Standing:
    """The network of what `read` has found: of a served session, or of a run at its instant.

    Nobody listens to it. Raises SnapshotError.
    """
    network, faults, *more = restore(found["network"], dict.fromkeys(_OF_A_RUN, Nobody()))
    usb, nodes = more if found.get("kind") == "served" else (None, {})
    network.wire._taps[:] = [tap for tap in network.wire._taps if tap is not nothing]
    network.plant.record(None)
    network.hid.to_host = None
    for uart in network.uarts.values():
        uart.sink = uart.line = None
    for port in network.debug.values():
        port.sink = None
    for node in nodes.values():
        node.port.on_receive = node.port.on_error = None
    return Standing(found["scenario"], found["model"], network, faults, found.get("entries", 0), usb, nodes)


_OUTSIDERS = (
    CandumpWriter, DebugFeed, EmulatedBus, Entry, ErrorFrames, Feed, Fence, Pacer, Punctuality, Recorder,
    SerialLink, Steps, UsbPlug,
)  # fmt: skip
"""Whoever hangs on a served network and is not of it."""
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")


class Snapshots:
    """`--snapshots DIR`: whoever reaches the control plane writes there only, by a name, and over nothing.

    Time stands still while one is taken, some hundredths of a second; the pace is not counted as missed.
    """

    def __init__(self, folder: Path, served: LiveNetwork, recording: Recording | None = None) -> None:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise LogError(f"{folder}: cannot be made: {reason(error)}") from None
        self._folder = folder
        self._served = served
        self._recording = recording
        served.snapshot = self.take

    def take(self, name: str) -> str:
        """Now, between two slices; returns what was written. Raises SnapshotError, LogError."""
        served = self._served
        name = name or f"{served.now_ns * 1e-9:.6f}s"
        file = self._folder / name
        if _NAME.fullmatch(name) is None:
            raise SnapshotError("a snapshot's name has letters, digits, dots and dashes, 64 at most")
        if file.exists():
            raise SnapshotError(f"there is a snapshot {name}; take another name")
        pacer, paused = served.pacer, served.pacer.paused
        pacer.paused = True
        try:
            size = write(whole(served), file)
        finally:
            pacer.paused = paused
        if self._recording is not None:
            self._recording.mark(name, served)
        return f"{file}: {served.now_ns * 1e-9:.6f} s, {served.entry.count} entries, {size} bytes"


def whole(served: LiveNetwork) -> dict[str, Any]:
    """What goes into the file, between two slices; raises SnapshotError."""
    inner = (served.network, served.faults, served.usb, served.nodes)
    return {
        "kind": "served",
        "scenario": served.scenario,
        "model": served.model,
        "entries": served.entry.count,
        "network": take(inner, outsiders=_OUTSIDERS),
    }
