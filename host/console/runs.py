"""Axis logs of the RS232 lines, recorded when a console asks for it."""

import sys
from collections import deque
from collections.abc import Callable, Collection
from pathlib import Path

from host.logs.axis import AxisLog
from host.logs.journal import Journal
from host.procedures.manual import AXES
from host.serial_link import SerialLink

_BEFORE = __name__.removesuffix("host.console.runs")
"""Before the rooms' names: nothing in a checkout, `schmidt.` in a wheel."""


class RecordedRuns:
    """Runs of both axes in a folder. Pages only ask; `poll` and `receive`, on the host's own thread, write.

    headers: of the logs, by axis. journal: where a broken packet is told. lines: boards whose RS232 line is
    there; nothing is recorded of others.
    """

    def __init__(
        self,
        folder: Path,
        headers: dict[str, dict[str, str]],
        journal: Journal,
        lines: Collection[str] = ("AXIS_RA", "AXIS_DEC"),
    ) -> None:
        self.folder = folder
        self._headers = headers
        self._journal = journal
        self._wanted: deque[Callable[[], None]] = deque()
        self._open: dict[str, tuple[SerialLink, AxisLog]] = {}
        self._axes = {axis: device for axis, device in AXES.items() if device.name in lines}
        self._count = max(len(self.logs(axis)) for axis in AXES)

    @property
    def recording(self) -> bool:
        """Whether files grow."""
        return bool(self._open)

    def start(self) -> None:
        """Begin a run; the one before ends. Raises ValueError when there is nothing to record."""
        if not self._axes:
            raise ValueError("no RS232 line of an axis board: give schmidt host --serial AXIS_RA=PORT")
        self._wanted.append(self._begin)

    def stop(self) -> None:
        """End the run."""
        self._wanted.append(self._end)

    def logs(self, axis: str) -> list[Path]:
        """Finished runs; while one is recorded it is not among them."""
        found = sorted(self.folder.glob(f"{axis}-*.csv"))
        return found[:-1] if AXES[axis].name in self._open else found

    def command(self, axis: str, out: Path) -> list[str]:
        """The command line that calibrates on them into `out`. It may take a minute: a program of its own."""
        logs = [str(path) for path in self.logs(axis)]
        program = f"from {_BEFORE}scenarios.cli import main; main()"
        return [sys.executable, "-c", program, "calibrate", *logs, "--out", str(out)]

    def poll(self) -> None:
        """Begin or end what was asked for."""
        while self._wanted:
            self._wanted.popleft()()

    def receive(self, now_ns: int, board: str, data: bytes) -> None:
        """Bytes from a board's line, at `now_ns`."""
        if board in self._open:
            self._open[board][0].receive(now_ns, data)

    def close(self) -> None:
        """Finish what is open."""
        self._end()

    def _begin(self) -> None:
        self._end()
        self._count += 1
        for axis, device in self._axes.items():
            log = AxisLog(self.folder / f"{axis}-{self._count:03d}.csv", self._headers[axis])
            self._open[device.name] = (SerialLink(device, self._journal, log.packet), log)

    def _end(self) -> None:
        for _, log in self._open.values():
            log.file.close()
        self._open.clear()
