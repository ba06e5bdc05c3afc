"""Runs an event queue in real time, in slices of about a millisecond: simulated time = speed × wall time.

Are the 5 ms ticks on time? `Punctuality` holds the wall time of each against when it is due.
"""

from collections import Counter, deque
from collections.abc import Callable
from itertools import accumulate
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
    paused: simulated time stands still. lateness_s: how late the last slice ended. slips: times the schedule
    was dropped because it was more than a quarter of a second behind. slipped_s: wall time given up that way.
    """

    def __init__(self, queue: EventQueue, speed: float = 1.0) -> None:
        self.queue = queue
        self.lateness_s = 0.0
        self.slips = 0
        self.slipped_s = 0.0
        self._paused = False
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
        self._slice_ns = round(SLICE_S * self._speed * _NS_PER_S)

    def due_s(self, t_ns: int) -> float:
        """When simulated time `t_ns` is due, on the clock of `perf_counter`."""
        return self._start_s + (t_ns - self._start_ns) / _NS_PER_S / self._speed

    def run(self, until_ns: int | None = None, each_slice: Callable[[], bool | None] | None = None) -> None:
        """Run until simulated time `until_ns`, or until `each_slice()`, asked before each slice, is True."""
        queue = self.queue
        self._restart()
        while until_ns is None or queue.now_ns < until_ns:
            if each_slice is not None and each_slice():
                return
            if self._paused:
                sleep(SLICE_S)
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
        if late_s > _GIVE_UP_LAG_S:
            self.slips += 1
            self.slipped_s += late_s
            self._restart()


TICK_NS = 5_000_000
ON_TIME_S = 1e-3
_KEPT = 1000
"""Late ticks that are remembered one by one."""
_BIN_S = 1e-5
"""Bins in which lateness is counted, s; of what is later than a second, in the last one."""
_LAST = 100_000


class Punctuality:
    """A probe on the queue every 5 ms of simulated time. It changes nothing that the boards do.

    due is when the pacer's schedule wants it; a schedule that was dropped (`Pacer.slips`) is late once.
    late: (due, lateness), s, of the last ticks that were more than 1 ms off. The clock is `perf_counter`,
    which other programs on the machine can read too.
    """

    def __init__(self, pacer: Pacer) -> None:
        self.worst_s = 0.0
        self.ticks = 0
        self.late: deque[tuple[float, float]] = deque(maxlen=_KEPT)
        self._bins: Counter[int] = Counter()
        self._pacer = pacer
        self.counting = True
        pacer.queue.at(pacer.queue.now_ns + TICK_NS, self._tick)

    def _tick(self, t_ns: int) -> None:
        if self.counting:
            due_s = self._pacer.due_s(t_ns)
            late_s = abs(perf_counter() - due_s)
            self._bins[min(int(late_s / _BIN_S), _LAST)] += 1
            self.ticks += 1
            if late_s > self.worst_s:
                self.worst_s = late_s
            if late_s > ON_TIME_S:
                self.late.append((due_s, late_s))
        self._pacer.queue.at(t_ns + TICK_NS, self._tick)

    @property
    def on_time(self) -> float:
        """Share of the ticks within 1 ms of due; nan before the first."""
        if not self.ticks:
            return float("nan")
        early = round(ON_TIME_S / _BIN_S)
        return sum(count for each, count in self._bins.items() if each < early) / self.ticks

    def quantile_s(self, share: float) -> float:
        """The lateness that `share` of the ticks stay below, to a bin, never more than the worst; nan before
        the first."""
        if not self.ticks:
            return float("nan")
        bins = sorted(self._bins)
        reached = accumulate(self._bins[each] for each in bins)
        last = next(each for each, ticks in zip(bins, reached, strict=True) if ticks >= share * self.ticks)
        return self.worst_s if last == _LAST else min((last + 1) * _BIN_S, self.worst_s)

    def restart(self) -> None:
        """Count afresh from here."""
        self.worst_s, self.ticks = 0.0, 0
        self._bins.clear()
        self.late.clear()

    def text(self) -> str:
        """One line."""
        if not self.ticks:
            return "no tick yet"
        return (
            f"{self.on_time:.2%} of {self.ticks} ticks within 1 ms of due "
            f"(99.9 % within {self.quantile_s(0.999) * 1e3:.2f} ms, worst {self.worst_s * 1e3:.1f} ms)"
        )
