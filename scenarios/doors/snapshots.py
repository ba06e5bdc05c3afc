"""`--snapshots DIR`: snapshots of a served session while it goes on, for who asks at the control plane."""

import re
from pathlib import Path
from typing import Any

from bus.can.candump import CandumpWriter
from bus.outside.door import Door as Fence
from bus.outside.errorframes import ErrorFrames
from bus.outside.pacer import Pacer, Punctuality
from host.serial_link import SerialLink
from scenarios.doors.busview import EmulatedBus
from scenarios.doors.debug_pty import DebugFeed
from scenarios.doors.entry import Entry
from scenarios.doors.lines import Feed
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.recording import Recording
from scenarios.doors.steps import Steps
from scenarios.doors.usb import UsbPlug
from scenarios.lab.recorder import Recorder
from scenarios.lab.snapshot.file import write
from scenarios.lab.snapshot.freeze import SnapshotError, take

_OUTSIDERS = (
    CandumpWriter, DebugFeed, EmulatedBus, Entry, ErrorFrames, Feed, Fence, Pacer, Punctuality, Recorder,
    SerialLink, Steps, UsbPlug,
)  # fmt: skip
"""Whoever hangs on a served network and is not of it."""
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")


class Snapshots:
    """Files in one folder, by names: whoever reaches the control plane writes nowhere else, and over nothing.

    Time stands still while one is taken, some hundredths of a second; the pace is not counted as missed.
    """

    def __init__(self, folder: Path, served: LiveNetwork, recording: Recording | None = None) -> None:
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
