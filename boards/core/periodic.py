"""A board whose work is done by one timer interrupt of the highest priority, as on all the boards of this
network."""

from collections.abc import Callable

from mypy_extensions import mypyc_attr

from boards.core.board import Board
from boards.core.interrupts import Source
from boards.core.place import Place
from boards.core.timer import Timer


@mypyc_attr(allow_interpreted_subclasses=True)
class PeriodicBoard(Board):
    """Subclasses write `routine(t_ns)`, whose first statement is `end = self.enter(t_ns)` followed by a
    return when 0."""

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
        """Account for the routine that starts at `t_ns` and arm the next one; returns its end, 0 when the
        board is off."""
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
