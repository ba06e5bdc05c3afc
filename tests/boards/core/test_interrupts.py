import pytest

from boards.core import InterruptController, Source
from boards.core.interrupts import Line
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
    with pytest.raises(ValueError, match="interrupt table: a must have the highest priority"):
        InterruptController(EventQueue(), FCY_HZ, (Source("a", 1, 0, 1), Source("b", 1, 0, 1)))


def test_cycles_are_rounded_up_to_whole_nanoseconds() -> None:
    cpu = InterruptController(EventQueue(), 3_000_000_000, (Source("top", 1, 1, 4),))
    assert [cpu.cycles_ns(cycles) for cycles in (0, 1, 3, 4)] == [0, 1, 1, 2]
    assert (cpu.top.latency_ns, cpu.top.cost_ns, cpu.top.own_ns) == (1, 2, 2)
    assert (cpu.fcy_hz, cpu.busy, cpu.top_end_ns, cpu.overruns) == (3_000_000_000, False, 0, 0)


def test_a_routine_waits_until_the_top_one_has_ended() -> None:
    queue, cpu, ends = controller()
    cpu.top_end_ns = 1100 * US
    queue.at(1000 * US, cpu.lines["middle"].request)
    queue.run_until(3000 * US)
    assert ends == [("middle", 1100 + 100)]


def test_what_is_preempted_loses_the_wait_for_the_top_routine_too() -> None:
    queue, cpu, ends = controller()
    queue.at(1000 * US, cpu.lines["low"].request)
    queue.at(1100 * US, lambda _t: setattr(cpu, "top_end_ns", 1150 * US))
    queue.at(1100 * US, cpu.lines["middle"].request)
    queue.run_until(3000 * US)
    assert ends == [("middle", 1150 + 100), ("low", 1000 + 5 + 200 + 150)]


def test_of_equals_the_first_row_goes_first_and_does_not_preempt() -> None:
    queue, cpu, ends = controller()
    queue.at(1000 * US, cpu.lines["middle"].request)
    for name in ("level", "low"):
        queue.at(1010 * US, cpu.lines[name].request)
    queue.run_until(3000 * US)
    assert ends == [("middle", 1105), ("low", 1310), ("level", 1325)]
    assert [line.runs for line in cpu.lines.values()] == [0, 1, 1, 1]
    assert [line.pending for line in cpu.lines.values()] == [False] * 4
    assert not cpu.busy


def test_a_processor_is_busy_while_a_routine_runs() -> None:
    queue, cpu, _ = controller()
    queue.at(1000 * US, cpu.lines["low"].request)
    queue.run_until(1100 * US)
    assert cpu.busy
    queue.run_until(1205 * US)
    assert not cpu.busy


def test_a_halt_starts_nothing_and_lets_go_of_what_was_running() -> None:
    queue, cpu, ends = controller()
    mask = Line(cpu, Source("halted", 100, 0, 0))
    queue.at(1000 * US, cpu.lines["low"].request)
    queue.run_until(1010 * US)
    assert cpu.halt(mask) == [cpu.lines["low"]] and cpu.busy
    cpu.lines["middle"].request(1010 * US)
    assert cpu.lines["middle"].pending
    cpu.resume(mask)
    assert cpu.busy  # the low one goes on
    cpu.dispatch(1010 * US)
    queue.run_until(3000 * US)
    assert [name for name, _ in ends] == ["middle", "low"]
    assert cpu.halt(mask) == []
    cpu.resume(mask)
    assert not cpu.busy


def test_a_routine_above_all_makes_the_others_longer() -> None:
    """6 us of every 20 us: a routine of 50 us meets four runs, so 74 us, and five would need 80."""
    _, cpu, _ = controller()
    cpu.steal(Source("pwm", 9, latency_cycles=2, cost_cycles=4), 20 * US)
    costs = {name: line.cost_ns // US for name, line in cpu.lines.items()}
    assert costs == {"top": 50 + 4 * 6, "middle": 100 + 8 * 6, "low": 200 + 15 * 6, "level": 10 + 6}
    assert [line.own_ns // US for line in cpu.lines.values()] == [50, 100, 200, 10]
    cpu.steal(None)
    assert [line.cost_ns // US for line in cpu.lines.values()] == [50, 100, 200, 10]


def test_a_line_without_a_routine_is_a_mistake_of_the_table() -> None:
    queue = EventQueue()
    cpu = InterruptController(queue, FCY_HZ, (Source("top", 1, 0, 1),))
    cpu.top.request(0)
    with pytest.raises(RuntimeError, match="interrupt without a routine"):
        queue.run_until(10 * US)
    assert cpu.top.end_ns == US
