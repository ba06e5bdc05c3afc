"""An interrupt table as times, which FIDELITY.md publishes."""

from boards.core import InterruptController, Source
from bus.time import EventQueue


def times_ns(table: tuple[Source, ...], fcy_hz: int) -> dict[str, tuple[int, int]]:
    """From the interrupt to the first instruction and from there to the end; the most urgent one first."""
    lines = InterruptController(EventQueue(), fcy_hz, table).lines
    priorities = [line.priority for line in lines.values()]
    assert priorities == sorted(set(priorities), reverse=True)
    return {name: (line.latency_ns, line.cost_ns) for name, line in lines.items()}
