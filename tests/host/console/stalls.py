"""When this machine runs nobody: a loop that only sleeps, ahead of all other programs, on one core.

`python -m tests.host.console.stalls CORE FILE` writes (due, how late) of every wake-up that was late, s on
the monotonic clock, until it is ended. What a virtual machine's owner or the kernel takes, it takes from
this loop too.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import TracebackType

PERIOD_S = 5e-4
"""A tenth of a tick: a stall of the 1 ms that makes a tick late cannot fall between two."""
NOTED_S = 2e-4
"""A fifth of the 1 ms that makes a tick late. ASSUMPTION."""


class Stalls:
    """The loop as a process beside a measurement; `at(due, late)` says whether it was stalled then."""

    def __init__(self, core: int, file: Path) -> None:
        self._file = file
        self._process = subprocess.Popen([sys.executable, "-m", __name__, str(core), str(file)])
        self.found: list[tuple[float, float]] = []

    def __enter__(self) -> Stalls:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._process.send_signal(signal.SIGTERM)
        if self._process.wait(30) == 0:
            self.found = [(due, late) for due, late in json.loads(self._file.read_text())]

    def share_of(self, due_s: float, late_s: float) -> float:
        """How much of a tick's lateness the machine ran nobody, 0..1."""
        end_s = due_s + late_s
        both = sum(max(0.0, min(end_s, due + late) - max(due_s, due)) for due, late in self.found)
        return both / late_s


def main(core: int, file: Path) -> None:
    os.sched_setaffinity(0, {core})
    os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(2))
    found: list[tuple[float, float]] = []
    ended: list[int] = []
    signal.signal(signal.SIGTERM, lambda number, _frame: ended.append(number))
    due_s = time.perf_counter()
    while not ended:
        due_s += PERIOD_S
        time.sleep(max(0.0, due_s - time.perf_counter()))
        now_s = time.perf_counter()
        if now_s - due_s > NOTED_S:
            found.append((due_s, now_s - due_s))
            due_s = now_s
    file.write_text(json.dumps(found))


if __name__ == "__main__":
    main(int(sys.argv[1]), Path(sys.argv[2]))
