"""A board whose work is done by one timer interrupt of the highest priority, as on all of this network.

The timer divides the board's own crystal, so no two boards share a 5 ms grid.
"""

from collections.abc import Callable
from typing import Final

from mypy_extensions import mypyc_attr

from boards.core.board import Board
from boards.core.interrupts import Source
from boards.core.place import Place
from bus.time import Oscillator

_BLOCK: Final = 64
"""Fires worked out at a time. The rate is constant in a block: 10 ppm/h is below 1e-6 ns in 0.64 s."""


class Timer:
    """Start times (true ns) of a periodic interrupt routine: fire time plus a fixed latency.

    times: those worked out so far, last first; `next_ns` without the call for whoever is in a hurry.

    oscillator: the board's crystal. period_ns: local time between fires. latency_ns: from fire to
        first instruction.
    """

    def __init__(self, oscillator: Oscillator, period_ns: int, latency_ns: int) -> None:
        if period_ns <= 0:
            raise ValueError(f"timer period is {period_ns} ns, must be positive")
        self.period_ns = period_ns
        self.latency_ns = latency_ns
        self._oscillator = oscillator
        self.times: list[int] = []
        self.restart(0)

    def restart(self, after_ns: int) -> None:
        """Let the next fire be the first one after true time `after_ns`."""
        period = self.period_ns
        self._local_ns = (self._oscillator.local_ns(after_ns) // period + 1) * period
        self._true_ns = self._oscillator.true_ns(self._local_ns)
        self.times.clear()

    def retime(self) -> None:
        """The crystal's rate has changed: work out again what has been worked out in advance."""
        self._local_ns -= len(self.times) * self.period_ns
        self._true_ns = self._oscillator.true_ns(self._local_ns)
        self.times.clear()

    def next_ns(self) -> int:
        """True time at which the next routine starts."""
        if not self.times:
            self._refill()
        return self.times.pop()

    def late(self, start_ns: int, end_ns: int) -> tuple[int, int]:
        """The processor is busy until `end_ns`, after `start_ns`: (when the routine runs instead,
        fires lost meanwhile).

        One fire is remembered by the interrupt flag; those that find the flag set are lost.
        """
        lost = 0
        following = self.next_ns()
        while following < end_ns:
            lost += 1
            following = self.next_ns()
        self.times.append(following)
        return end_ns, lost

    def _refill(self) -> None:
        self._local_ns += _BLOCK * self.period_ns
        start = self._true_ns
        self._true_ns = end = self._oscillator.true_ns(self._local_ns)
        span = end - start
        start += self.latency_ns
        self.times = [start + k * span // _BLOCK for k in range(_BLOCK - 1, -1, -1)]


@mypyc_attr(allow_interpreted_subclasses=True)
class PeriodicBoard(Board):
    """Subclasses write `routine(t_ns)`: first `end = self.enter(t_ns)`, and a return when that is 0."""

    def __init__(self, place: Place, fcy_hz: int, table: tuple[Source, ...], period_ns: int) -> None:
        super().__init__(place, fcy_hz, table)
        self.period_ns = period_ns
        self.cost_ns = self.cpu.top.cost_ns
        self.timer = Timer(place.oscillator, period_ns, self.cpu.top.latency_ns)
        self.ticks = 0
        self._routine: Callable[[int], None] = self.routine

    def routine(self, t_ns: int) -> None:
        """The interrupt routine; `t_ns` is its first instruction."""
        raise NotImplementedError

    def start(self, t_ns: int) -> None:
        """Arm the timer."""
        self.ticks = 0
        self.timer.restart(t_ns)
        first = self.timer.next_ns()
        self.epoch_ns = first - self.period_ns
        self.queue.at(first, self._routine)

    def enter(self, t_ns: int) -> int:
        """Account for the routine that starts at `t_ns`, arm the next one; returns its end, 0: board off."""
        if not self.on:
            return 0
        cpu = self.cpu
        cost = self.cost_ns
        cpu.top_end_ns = end = t_ns + cost
        if cpu.busy:
            cpu.interrupted(cost)
        timer = self.timer
        times = timer.times
        start = times.pop() if times else timer.next_ns()
        if start < end:
            start, lost = timer.late(start, end)
            cpu.top.overruns += lost
        self.ticks = ticks = self.ticks + 1
        self.epoch_ns = t_ns - ticks * self.period_ns
        self.queue.at(start, self._routine)
        return end
