"""`--snapshots DIR`: snapshots of a served session while it goes on, for who asks at the control plane."""

from __future__ import annotations

import re
from pathlib import Path

from scenarios.doors.recording import Recording
from scenarios.doors.served import Served
from scenarios.snapshot.file import write
from scenarios.snapshot.freeze import SnapshotError
from scenarios.snapshot.served import whole

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")


class Snapshots:
    """Files in one folder, by names: whoever reaches the control plane writes nowhere else, and over nothing.

    Time stands still while one is taken, some hundredths of a second; the pace is not counted as missed.
    """

    def __init__(self, folder: Path, served: Served, recording: Recording | None = None) -> None:
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
