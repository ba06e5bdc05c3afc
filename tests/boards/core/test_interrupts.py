import pytest

from boards.core import InterruptController, Source
from bus.time import EventQueue

FCY_HZ = 1_000_000
"""One cycle is a microsecond, so the figures below are easy to read."""
US = 1000


def controller() -> tuple[EventQueue, InterruptController, list[tuple[str, int]]]:
    queue = EventQueue()
    table = (
        Source("top", 3, latency_cycles=0, cost_cycles=50),
        Source("middle", 2, latency_cycles=5, cost_cycles=100),
        Source("low", 1, latency_cycles=5, cost_cycles=200),
        Source("level", 1, latency_cycles=5, cost_cycles=10, level=True),
    )
    cpu = InterruptController(queue, FCY_HZ, table)
    ends: list[tuple[str, int]] = []
    for name, line in cpu.lines.items():
        line.body = lambda t_ns, name=name: ends.append((name, t_ns // US))  # type: ignore[misc]
    return queue, cpu, ends


def test_B9_outputs_take_effect_at_the_end_of_the_routine() -> None:
    queue, cpu, ends = controller()
    queue.at(1000 * US, cpu.lines["low"].request)
    queue.run_until(2000 * US)
    assert ends == [("low", 1000 + 5 + 200)]


def test_B9_a_higher_priority_preempts_and_delays_the_lower() -> None:
    queue, cpu, ends = controller()
    queue.at(1000 * US, cpu.lines["low"].request)
    queue.at(1100 * US, cpu.lines["middle"].request)
    queue.run_until(2000 * US)
    assert ends == [("middle", 1100 + 5 + 100), ("low", 1000 + 5 + 200 + 5 + 100)]


def test_B9_a_lower_priority_waits() -> None:
    queue, cpu, ends = controller()
    queue.at(1000 * US, cpu.lines["middle"].request)
    queue.at(1050 * US, cpu.lines["low"].request)
    queue.run_until(2000 * US)
    assert ends == [("middle", 1105), ("low", 1105 + 5 + 200)]


def test_B9_the_top_routine_takes_its_time_from_the_others() -> None:
    queue, cpu, ends = controller()
    queue.at(1000 * US, cpu.lines["low"].request)
    queue.at(1100 * US, lambda _t: cpu.interrupted(50 * US) if cpu.busy else None)
    queue.run_until(2000 * US)
    assert ends == [("low", 1000 + 5 + 200 + 50)]


def test_B9_a_flag_that_is_set_already_is_a_counted_overrun() -> None:
    queue, cpu, ends = controller()
    for t in (1000, 1010, 1020, 1030):
        queue.at(t * US, cpu.lines["middle"].request)
    queue.run_until(3000 * US)
    # the first runs at once, the second waits for it, the third and fourth find the flag set
    assert len(ends) == 2
    assert cpu.overruns == cpu.lines["middle"].overruns == 2


def test_a_level_line_loses_nothing() -> None:
    queue, cpu, _ = controller()
    for t in (1000, 1001, 1002):
        queue.at(t * US, cpu.lines["level"].request)
    queue.run_until(3000 * US)
    assert cpu.overruns == 0


def test_the_first_row_must_be_the_most_urgent() -> None:
    with pytest.raises(ValueError, match="highest priority"):
        InterruptController(EventQueue(), FCY_HZ, (Source("a", 1, 0, 1), Source("b", 1, 0, 1)))
