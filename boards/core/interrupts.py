"""The interrupt controller: priorities, latency, cost, preemption, lost flags.

A board's table names its sources. The routine of the highest priority can not be interrupted. Its end is
known at its start, so it runs in one event and stamps its outputs with that end. Everything below
may be interrupted: its body runs at its end, which every interruption moves.
"""

from collections.abc import Callable
from dataclasses import dataclass

from bus.time import EventQueue


@dataclass(frozen=True, slots=True)
class Source:
    """One row of a board's interrupt table.

    priority: higher interrupts lower.
    latency_cycles: from the request to the first instruction of the routine.
    cost_cycles: the routine, return included.
    level: the request line stays up until served (an SPI chip's INT pin). Otherwise it is a flag, and
        a second request before the routine starts is lost and counted.
    """

    name: str
    priority: int
    latency_cycles: int
    cost_cycles: int
    level: bool = False


class Line:
    """A source at run time. `body(t_end_ns)` is called when the routine ends."""

    def __init__(self, controller: "InterruptController", source: Source) -> None:
        self._controller = controller
        self.source = source
        self.priority = source.priority
        self.latency_ns = controller.cycles_ns(source.latency_cycles)
        self.own_ns = self.cost_ns = controller.cycles_ns(source.cost_cycles)
        self.body: Callable[[int], None] = _no_routine
        self.pending = False
        self.overruns = 0
        self.runs = 0
        self.end_ns = 0

    def request(self, t_ns: int) -> None:
        """The hardware raises this line at `t_ns` (the present)."""
        if self.pending:
            if not self.source.level:
                self.overruns += 1
            return
        self.pending = True
        self._controller.dispatch(t_ns)

    def complete(self, t_ns: int) -> None:
        """Event: the routine should be through now, unless something interrupted it."""
        if t_ns < self.end_ns:
            self._controller.queue.at(self.end_ns, self.complete)
            return
        self._controller.finish(self, t_ns)


def _no_routine(_t_ns: int) -> None:
    raise RuntimeError("interrupt without a routine: the board's table and its firmware disagree")


class InterruptController:
    """Runs the lines of one processor.

    queue: simulation time. fcy_hz: instruction rate. table: the sources; the first row is the
        uninterruptible one.
    """

    def __init__(self, queue: EventQueue, fcy_hz: int, table: tuple[Source, ...]) -> None:
        if any(row.priority >= table[0].priority for row in table[1:]):
            raise ValueError(
                f"interrupt table: {table[0].name} must have the highest priority, it comes first"
            )
        self.queue = queue
        self.fcy_hz = fcy_hz
        self.lines = {row.name: Line(self, row) for row in table}
        self.top = self.lines[table[0].name]
        self.top_end_ns = 0
        self.busy = False
        self._running: list[Line] = []

    def cycles_ns(self, cycles: int) -> int:
        """Duration of `cycles` instruction cycles, ns, rounded up."""
        return -(-cycles * 1_000_000_000 // self.fcy_hz)

    @property
    def overruns(self) -> int:
        """Interrupts lost so far on all lines."""
        return sum(line.overruns for line in self.lines.values())

    def steal(self, source: Source | None, period_ns: int = 0) -> None:
        """A short routine above all others runs every `period_ns`: each routine takes longer by the most of
        its runs that can fall into it. None: there is no such routine any more.

        Booked, not simulated: a PWM interrupt of 20 kHz would cost more events than all the rest.
        """
        taken = 0 if source is None else self.cycles_ns(source.latency_cycles + source.cost_cycles)
        for line in self.lines.values():
            own = line.own_ns
            line.cost_ns = own
            if taken:
                while line.cost_ns < own + -(-line.cost_ns // period_ns) * taken:
                    line.cost_ns = own + -(-line.cost_ns // period_ns) * taken

    def interrupted(self, cost_ns: int) -> None:
        """The top routine takes `cost_ns` away from whatever is running; call it when `busy`."""
        for line in self._running:
            line.end_ns += cost_ns

    def halt(self, mask: Line) -> list[Line]:
        """Put `mask` above everything: nothing starts any more. Returns what is running."""
        running = list(self._running)
        self._running.append(mask)
        self.busy = True
        return running

    def resume(self, mask: Line) -> None:
        """Take `mask` away again."""
        self._running.remove(mask)
        self.busy = bool(self._running)

    def dispatch(self, t_ns: int) -> None:
        """Start the most urgent pending line if it may run now."""
        running = self._running
        level = running[-1].priority if running else 0
        best: Line | None = None
        for line in self.lines.values():
            if line.pending and line.priority > level:
                best, level = line, line.priority
        if best is None:
            return
        best.pending = False
        start = max(t_ns + best.latency_ns, self.top_end_ns)
        taken = start + best.cost_ns - t_ns
        for line in running:
            line.end_ns += taken
        best.end_ns = start + best.cost_ns
        running.append(best)
        self.busy = True
        self.queue.at(best.end_ns, best.complete)

    def finish(self, line: Line, t_ns: int) -> None:
        """`line` has run to its end: its outputs take effect, the next one may start."""
        self._running.remove(line)
        self.busy = bool(self._running)
        line.runs += 1
        line.body(t_ns)
        self.dispatch(t_ns)
