"""A telescope on the emulated boards in a process of its own pace: a thread ticks, doors are open."""

import datetime as dt
import threading
from pathlib import Path
from time import monotonic, sleep

from scenarios.doors.options import ServeOptions
from tests.host.telescope.conftest import START, Rig


class Live(Rig):
    """The rig, run by a thread at `speed` times real time at most (faster machines wait)."""

    def __init__(
        self,
        logs: Path | None = None,
        speed: float = 20.0,
        start: dt.datetime = START,
        network: str = "lab",
        cameras: bool = False,
    ) -> None:
        super().__init__(logs, start, network)
        if cameras:
            self.host.open_cameras(ServeOptions(asked={"alpaca": ("0",)}))
        self.outside = self.host.outside
        self.speed = speed
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        slice_s = 0.02
        while not self._end.is_set():
            self.advance(slice_s * self.speed)
            sleep(slice_s)

    def let(self, seconds: float) -> None:
        """Wait until this much simulated time has gone by, however slow the machine is."""
        end_s = self.telescope.snapshot.t_s + seconds
        limit = monotonic() + 120.0
        while self.telescope.snapshot.t_s < end_s:
            assert monotonic() < limit, "simulated time stands still"
            sleep(0.01)

    def close(self) -> None:
        self._end.set()
        self._thread.join()
        self.host.close()
