"""The event queue: the only source of time for everything below the host's door."""

from collections.abc import Callable
from heapq import heappop, heappush
from itertools import count


class PastEventError(ValueError):
    """Somebody asked to be called at a time that has already gone by."""


class EventQueue:
    """Calls in order of time; at the same time, in the order in which they were asked for.

    Times are integer nanoseconds since the start of the simulation.
    """

    __slots__ = ("_heap", "_ticket", "now_ns")

    def __init__(self) -> None:
        self.now_ns: int = 0
        self._heap: list[tuple[int, int, Callable[[int], None]]] = []
        # The ticket keeps equal times first come, first served, and heapq off comparing callables.
        self._ticket = count().__next__

    def at(self, t_ns: int, call: Callable[[int], None]) -> None:
        """Have `call(t_ns)` made at `t_ns`; raises PastEventError when that is before `now_ns`."""
        if t_ns < self.now_ns:
            raise PastEventError(f"event at {t_ns} ns lies before the present, {self.now_ns} ns")
        heappush(self._heap, (t_ns, self._ticket(), call))

    def run_until(self, t_ns: int) -> None:
        """Make every call due up to and including `t_ns`, then let `now_ns` be `t_ns`.

        If a call raises, the event is consumed and `now_ns` stays at its time.
        """
        heap = self._heap
        while heap and heap[0][0] <= t_ns:
            now, _, call = heappop(heap)
            self.now_ns = now
            call(now)
        if t_ns > self.now_ns:
            self.now_ns = t_ns

    def next_ns(self) -> int | None:
        """Time of the earliest event, ns, or None when nothing is waiting."""
        return self._heap[0][0] if self._heap else None

    def __len__(self) -> int:
        return len(self._heap)
