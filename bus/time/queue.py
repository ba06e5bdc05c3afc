"""The event queue: the only source of time for everything below the host's door."""

from bisect import bisect_left
from collections.abc import Callable
from typing import Any, Final


class PastEventError(ValueError):
    """Somebody asked to be called at a time that has already gone by."""


def _search(before: list[int], key: int) -> int:
    """`bisect_left` where compiled, without its calls and comparisons of objects: half the cost."""
    low, high = 0, len(before)
    while low < high:
        middle = (low + high) >> 1
        if before[middle] < key:
            low = middle + 1
        else:
            high = middle
    return low


_COMPILED: Final = not hasattr(_search, "__code__")


class EventQueue:
    """Calls in order of time; at the same time, in the order in which they were asked for.

    Times are integer nanoseconds since the start of the simulation.
    """

    def __init__(self) -> None:
        self.now_ns: int = 0
        # Sorted, the earliest event last, times negated: for an event or two per node quicker than a heap.
        self._before: list[int] = []
        self._calls: list[Callable[[int], None]] = []

    def at(self, t_ns: int, call: Callable[[int], None]) -> None:
        """Have `call(t_ns)` made at `t_ns`; raises PastEventError when that is before `now_ns`."""
        if t_ns < self.now_ns:
            raise PastEventError(f"event at {t_ns} ns lies before the present, {self.now_ns} ns")
        before = self._before
        key: Any = -t_ns  # compiled code makes an object of it once, not for either call
        place = (
            _search(before, -t_ns) if _COMPILED else bisect_left(before, key)
        )  # behind all of the same time
        before.insert(place, key)
        self._calls.insert(place, call)

    def run_until(self, t_ns: int) -> None:
        """Make every call due up to and including `t_ns`, then let `now_ns` be `t_ns`.

        If a call raises, the event is consumed and `now_ns` stays at its time.
        """
        before, calls = self._before, self._calls
        while before:
            now = -before[-1]
            if now > t_ns:
                break
            before.pop()
            self.now_ns = now
            calls.pop()(now)
        if t_ns > self.now_ns:
            self.now_ns = t_ns

    def take_out(
        self, which: Callable[[Callable[[int], None]], bool]
    ) -> list[tuple[int, Callable[[int], None]]]:
        """Remove events whose call `which` picks; returns (time, call) in order. For who stops a clock."""
        events = list(zip(self._before, self._calls, strict=True))
        taken = [(-before, call) for before, call in reversed(events) if which(call)]
        kept = [event for event in events if not which(event[1])]
        self._before[:] = [before for before, _ in kept]  # in place: whoever runs the queue holds these lists
        self._calls[:] = [call for _, call in kept]
        return taken

    def next_ns(self) -> int | None:
        """Time of the earliest event, ns, or None when nothing is waiting."""
        return -self._before[-1] if self._before else None

    def __len__(self) -> int:
        return len(self._before)
