from time import perf_counter, sleep

import pytest

from bus.pacer import Pacer, SpeedError
from bus.time import EventQueue


@pytest.mark.parametrize("speed", [1.0, 5.0])
def test_simulated_time_keeps_step_with_the_wall(speed: float) -> None:
    queue = EventQueue()
    start = perf_counter()
    Pacer(queue, speed).run(until_ns=round(0.2 * speed * 1e9))
    assert queue.now_ns == round(0.2 * speed * 1e9)
    assert perf_counter() - start >= 0.199


def test_each_slice_may_stop_it() -> None:
    queue = EventQueue()
    pacer = Pacer(queue)
    pacer.run(each_slice=lambda: queue.now_ns >= 10_000_000)
    assert queue.now_ns == 10_000_000


def test_lateness_is_reported_and_a_long_pause_is_not_made_up_for() -> None:
    queue = EventQueue()
    queue.at(5_000_000, lambda _: sleep(1.1))
    pacer = Pacer(queue)
    start = perf_counter()
    pacer.run(until_ns=20_000_000)
    assert pacer.slips == 1
    assert pacer.worst_lateness_s >= 1.0
    assert perf_counter() - start >= 1.1 + 0.014


@pytest.mark.parametrize("speed", [0.0, -1.0, float("nan")])
def test_speeds_that_are_none(speed: float) -> None:
    with pytest.raises(SpeedError, match="above 0"):
        Pacer(EventQueue(), speed)
