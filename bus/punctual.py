"""Are the 5 ms ticks on time? Wall time at which each happens against when it is due."""

from time import perf_counter

from bus.pacer import Pacer

TICK_NS = 5_000_000
ON_TIME_S = 1e-3
_BINS = 2000
_BIN_S = 1e-5
"""Histogram of |lateness|: 10 µs up to 20 ms, and one bin for the rest."""


class Punctuality:
    """A probe on the queue every 5 ms of simulated time. It changes nothing that the boards do.

    due is when the pacer's schedule wants it; a schedule that was dropped (`Pacer.slips`) is late once.
    """

    def __init__(self, pacer: Pacer) -> None:
        self.worst_s = 0.0
        self.ticks = 0
        self._late = [0] * (_BINS + 1)
        self._pacer = pacer
        self.counting = True
        pacer.queue.at(pacer.queue.now_ns + TICK_NS, self._tick)

    def _tick(self, t_ns: int) -> None:
        if self.counting:
            late_s = abs(perf_counter() - self._pacer.due_s(t_ns))
            self._late[min(int(late_s / _BIN_S), _BINS)] += 1
            self.ticks += 1
            if late_s > self.worst_s:
                self.worst_s = late_s
        self._pacer.queue.at(t_ns + TICK_NS, self._tick)

    @property
    def on_time(self) -> float:
        """Share of the ticks within 1 ms of due; nan before the first."""
        return sum(self._late[: round(ON_TIME_S / _BIN_S)]) / self.ticks if self.ticks else float("nan")

    def quantile_s(self, share: float) -> float:
        """The lateness that `share` of the ticks stay below, to 10 µs; inf when beyond 20 ms."""
        need, seen = share * self.ticks, 0
        for index, count in enumerate(self._late):
            seen += count
            if seen >= need:
                return (index + 1) * _BIN_S if index < _BINS else float("inf")
        return float("nan")

    def text(self) -> str:
        """One line."""
        if not self.ticks:
            return "no tick yet"
        return (
            f"{self.on_time:.2%} of {self.ticks} ticks within 1 ms of due "
            f"(99.9 % within {self.quantile_s(0.999) * 1e3:.2f} ms, worst {self.worst_s * 1e3:.1f} ms)"
        )
