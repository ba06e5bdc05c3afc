"""Runs an event queue in real time: simulated time = speed × wall time, in slices of about a millisecond."""

from collections.abc import Callable
from time import perf_counter, sleep

from bus.time import EventQueue

SLICE_S = 0.001
"""Wall time per slice: how late the outside world is looked at."""
_GIVE_UP_LAG_S = 1.0
"""Beyond this the schedule is dropped and starts afresh, or a pause would be followed by a rush."""
_NS_PER_S = 1_000_000_000


class SpeedError(ValueError):
    """A speed that is not above zero."""


class Pacer:
    """Paces `queue` at `speed` (1: real time). The only place below the host's door that reads the
    wall clock.

    lateness_s: how late the last slice ended; worst_lateness_s: the worst so far; slips: times the
        schedule was
    dropped because it was more than a second behind.
    """

    def __init__(self, queue: EventQueue, speed: float = 1.0, slice_s: float = SLICE_S) -> None:
        if not speed > 0:
            raise SpeedError(f"speed {speed} must be above 0")
        self.queue = queue
        self.speed = speed
        self.lateness_s = 0.0
        self.worst_lateness_s = 0.0
        self.slips = 0
        self._slice_ns = max(1, round(slice_s * speed * _NS_PER_S))

    def run(self, until_ns: int | None = None, each_slice: Callable[[], bool | None] | None = None) -> None:
        """Run until simulated time `until_ns`, or until `each_slice()`, called before every slice, returns
        True."""
        queue = self.queue
        start_ns, start_s = queue.now_ns, perf_counter()
        while until_ns is None or queue.now_ns < until_ns:
            if each_slice is not None and each_slice():
                return
            target_ns = queue.now_ns + self._slice_ns
            queue.run_until(target_ns if until_ns is None else min(target_ns, until_ns))
            due_s = start_s + (queue.now_ns - start_ns) / _NS_PER_S / self.speed
            early_s = due_s - perf_counter()
            self.lateness_s = max(0.0, -early_s)
            self.worst_lateness_s = max(self.worst_lateness_s, self.lateness_s)
            if early_s > 0:
                sleep(early_s)
            elif self.lateness_s > _GIVE_UP_LAG_S:
                self.slips += 1
                start_ns, start_s = queue.now_ns, perf_counter()
