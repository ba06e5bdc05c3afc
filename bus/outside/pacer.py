"""Runs an event queue in real time: simulated time = speed × wall time, in slices of about a millisecond."""

from collections.abc import Callable
from time import perf_counter, sleep

from bus.time import EventQueue

SLICE_S = 0.001
"""Wall time per slice: how often the outside world is looked at."""
SLOWEST, FASTEST = 0.01, 1000.0
"""Speeds that make sense: below, nothing seems to happen; above, a slice is longer than a second."""
_GIVE_UP_LAG_S = 0.25
"""Beyond this the schedule is dropped and starts afresh, or a pause would be followed by a rush."""
_NS_PER_S = 1_000_000_000


class SpeedError(ValueError):
    """A speed that cannot be paced."""


def checked_speed(speed: float) -> float:
    """`speed`, or SpeedError with the range."""
    if not SLOWEST <= speed <= FASTEST:
        raise SpeedError(f"speed {speed:g} must be within {SLOWEST:g} to {FASTEST:g}")
    return speed


class Pacer:
    """Paces `queue` at `speed` (1: real time), which may be changed while it runs.

    A slice is run when the middle of it is due, so that nothing is more than half a slice early or late.
    paused: simulated time stands still. lateness_s: how late the last slice ended. worst_lateness_s: the
    worst so far. slips: times the schedule was dropped because it was more than a quarter of a second behind.
    slipped_s: wall time given up that way (time was slowed by it).
    """

    def __init__(self, queue: EventQueue, speed: float = 1.0, slice_s: float = SLICE_S) -> None:
        self.queue = queue
        self.lateness_s = 0.0
        self.worst_lateness_s = 0.0
        self.slips = 0
        self.slipped_s = 0.0
        self._paused = False
        self._slice_s = slice_s
        self._speed = checked_speed(speed)
        self._restart()

    @property
    def speed(self) -> float:
        """Simulated over wall time; raises SpeedError when set to what cannot be paced."""
        return self._speed

    @speed.setter
    def speed(self, speed: float) -> None:
        self._speed = checked_speed(speed)
        self._restart()

    @property
    def paused(self) -> bool:
        """Whether simulated time stands still."""
        return self._paused

    @paused.setter
    def paused(self, paused: bool) -> None:
        if paused != self._paused:
            self._paused = paused
            self._restart()

    def _restart(self) -> None:
        """The schedule begins here and now."""
        self._start_ns, self._start_s = self.queue.now_ns, perf_counter()
        self._slice_ns = max(1, round(self._slice_s * self._speed * _NS_PER_S))

    def due_s(self, t_ns: int) -> float:
        """When simulated time `t_ns` is due, on the clock of `perf_counter`."""
        return self._start_s + (t_ns - self._start_ns) / _NS_PER_S / self._speed

    def run(self, until_ns: int | None = None, each_slice: Callable[[], bool | None] | None = None) -> None:
        """Run until simulated time `until_ns`, or until `each_slice()`, called before every slice, returns
        True."""
        queue = self.queue
        self._restart()
        while until_ns is None or queue.now_ns < until_ns:
            if each_slice is not None and each_slice():
                return
            if self._paused:
                sleep(self._slice_s)
                continue
            target_ns = queue.now_ns + self._slice_ns
            target_ns = target_ns if until_ns is None else min(target_ns, until_ns)
            early_s = self.due_s((queue.now_ns + target_ns) // 2) - perf_counter()
            if early_s > 0:
                sleep(early_s)
            queue.run_until(target_ns)
            self._account(perf_counter() - self.due_s(queue.now_ns))

    def _account(self, late_s: float) -> None:
        self.lateness_s = max(0.0, late_s)
        self.worst_lateness_s = max(self.worst_lateness_s, self.lateness_s)
        if late_s > _GIVE_UP_LAG_S:
            self.slips += 1
            self.slipped_s += late_s
            self._restart()
