"""Are the 5 ms ticks on time? Wall time at which each happens against when it is due."""

from collections import deque
from time import perf_counter

from bus.outside.pacer import Pacer

TICK_NS = 5_000_000
ON_TIME_S = 1e-3
_KEPT = 1000
"""Late ticks that are remembered one by one."""
_BIN_S, _FINE = 1e-5, 2000
_COARSE_S, _COARSE = 1e-3, 1000
"""Histogram of |lateness|: bins of 10 µs up to 20 ms, of 1 ms up to a second, and one for the rest."""


def _bin(late_s: float) -> int:
    """Where a lateness is counted."""
    if late_s < _FINE * _BIN_S:
        return int(late_s / _BIN_S)
    return _FINE + min(int((late_s - _FINE * _BIN_S) / _COARSE_S), _COARSE)


def _edge(index: int) -> float:
    """Upper edge of a bin, s; inf for the last."""
    if index < _FINE:
        return (index + 1) * _BIN_S
    above = index - _FINE + 1
    return _FINE * _BIN_S + above * _COARSE_S if above <= _COARSE else float("inf")


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
        self._late = [0] * (_FINE + _COARSE + 1)
        self._pacer = pacer
        self.counting = True
        pacer.queue.at(pacer.queue.now_ns + TICK_NS, self._tick)

    def _tick(self, t_ns: int) -> None:
        if self.counting:
            due_s = self._pacer.due_s(t_ns)
            late_s = abs(perf_counter() - due_s)
            self._late[_bin(late_s)] += 1
            self.ticks += 1
            if late_s > self.worst_s:
                self.worst_s = late_s
            if late_s > ON_TIME_S:
                self.late.append((due_s, late_s))
        self._pacer.queue.at(t_ns + TICK_NS, self._tick)

    @property
    def on_time(self) -> float:
        """Share of the ticks within 1 ms of due; nan before the first."""
        return sum(self._late[: round(ON_TIME_S / _BIN_S)]) / self.ticks if self.ticks else float("nan")

    def quantile_s(self, share: float) -> float:
        """The lateness that `share` of the ticks stay below, to a bin, never more than the worst; nan before
        the first."""
        if not self.ticks:
            return float("nan")
        need, seen = share * self.ticks, 0
        for index, count in enumerate(self._late):
            seen += count
            if seen >= need:
                return min(_edge(index), self.worst_s)
        return self.worst_s

    def restart(self) -> None:
        """Count afresh from here."""
        self.worst_s, self.ticks = 0.0, 0
        self._late = [0] * len(self._late)
        self.late.clear()

    def text(self) -> str:
        """One line."""
        if not self.ticks:
            return "no tick yet"
        return (
            f"{self.on_time:.2%} of {self.ticks} ticks within 1 ms of due "
            f"(99.9 % within {self.quantile_s(0.999) * 1e3:.2f} ms, worst {self.worst_s * 1e3:.1f} ms)"
        )
