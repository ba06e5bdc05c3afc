"""The event queue: the only source of time for everything below the host's door."""

from collections.abc import Callable
from functools import partial
from heapq import heappop, heappush
from itertools import count

Event = tuple[int, int, Callable[[int], None]]
"""(time, ticket, call)."""


class PastEventError(ValueError):
    """Somebody asked to be called at a time that has already gone by."""


class EventQueue:
    """Calls in order of time; at the same time, in the order in which they were asked for.

    Times are integer nanoseconds since the start of the simulation.

    push, ticket: `push((t_ns, ticket(), call))` is `at(t_ns, call)` without its check, for whoever does it
        thousands of times a second and knows that `t_ns` is not in the past.
    """

    __slots__ = ("_heap", "now_ns", "push", "ticket")

    def __init__(self) -> None:
        self.now_ns: int = 0
        self._heap: list[Event] = []
        # The ticket keeps equal times first come, first served, and heapq off comparing callables.
        self.ticket: Callable[[], int] = count().__next__
        self.push: Callable[[Event], None] = partial(heappush, self._heap)

    def at(self, t_ns: int, call: Callable[[int], None]) -> None:
        """Have `call(t_ns)` made at `t_ns`; raises PastEventError when that is before `now_ns`."""
        if t_ns < self.now_ns:
            raise PastEventError(f"event at {t_ns} ns lies before the present, {self.now_ns} ns")
        heappush(self._heap, (t_ns, self.ticket(), call))

    def run_until(self, t_ns: int) -> None:
        """Make every call due up to and including `t_ns`, then let `now_ns` be `t_ns`.

        If a call raises, the event is consumed and `now_ns` stays at its time.
        """
        heap = self._heap
        while heap:
            event = heappop(heap)
            now = event[0]
            if now > t_ns:
                heappush(heap, event)
                break
            self.now_ns = now
            event[2](now)
        if t_ns > self.now_ns:
            self.now_ns = t_ns

    def next_ns(self) -> int | None:
        """Time of the earliest event, ns, or None when nothing is waiting."""
        return self._heap[0][0] if self._heap else None

    def __len__(self) -> int:
        return len(self._heap)
