from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from boards.core import Timer
from bus.time import Oscillator

PERIOD_NS = 5_000_000


def test_every_start_is_a_multiple_of_the_period_on_the_boards_own_clock() -> None:
    crystal = Oscillator(37.5, 123_456_789, 0.2)
    timer = Timer(crystal, PERIOD_NS, latency_ns=300)
    for _ in range(500):
        local = crystal.local_ns(timer.next_ns() - 300)
        assert min(local % PERIOD_NS, PERIOD_NS - local % PERIOD_NS) <= 1


@given(ppm=st.floats(-100, 100), phase=st.integers(0, 10**9), after=st.integers(0, 10**12))
def test_starts_follow_one_another_by_a_period(ppm: float, phase: int, after: int) -> None:
    timer = Timer(Oscillator(ppm, phase), PERIOD_NS, latency_ns=0)
    timer.restart(after)
    starts = [timer.next_ns() for _ in range(200)]
    assert starts[0] > after
    gaps = {later - earlier for earlier, later in pairwise(starts)}
    assert max(gaps) - min(gaps) <= 1
    assert abs(min(gaps) - PERIOD_NS * (1 - ppm * 1e-6)) < 2


def test_a_late_routine_keeps_one_fire_and_loses_the_rest() -> None:
    timer = Timer(Oscillator(0.0, 0), PERIOD_NS, latency_ns=0)
    start = timer.next_ns()
    assert timer.late(start, start + 1) == (start + 1, 0)
    start = timer.next_ns()
    # busy over three further fires: `start` itself is remembered, three are lost
    assert timer.late(start, start + 3 * PERIOD_NS + 1) == (start + 3 * PERIOD_NS + 1, 3)
    assert timer.next_ns() == start + 4 * PERIOD_NS


def test_the_first_fire_is_after_the_start_and_a_routine_begins_a_latency_later() -> None:
    timer = Timer(Oscillator(0.0, 0), PERIOD_NS, latency_ns=300)
    assert (timer.period_ns, timer.latency_ns) == (PERIOD_NS, 300)
    assert [timer.next_ns() for _ in range(3)] == [k * PERIOD_NS + 300 for k in (1, 2, 3)]
    timer.restart(7 * PERIOD_NS)  # at a fire: the next one counts
    assert timer.next_ns() == 8 * PERIOD_NS + 300
    timer.restart(7 * PERIOD_NS - 1)
    assert timer.next_ns() == 7 * PERIOD_NS + 300


def test_fires_of_many_seconds_are_those_of_the_crystal() -> None:
    crystal = Oscillator(80.0, 1_234_567)
    timer = Timer(crystal, PERIOD_NS, latency_ns=0)
    first = (1_234_567 // PERIOD_NS + 1) * PERIOD_NS
    for k in range(1000):
        assert abs(timer.next_ns() - crystal.true_ns(first + k * PERIOD_NS)) <= 1


def test_a_crystal_that_is_pulled_moves_the_fires_that_were_worked_out() -> None:
    crystal = Oscillator(0.0, 0)
    timer = Timer(crystal, PERIOD_NS, latency_ns=0)
    for _ in range(10):
        last = timer.next_ns()
    crystal.pull(last, 1000.0)
    timer.retime()
    gaps = [timer.next_ns() for _ in range(100)]
    assert gaps[0] == pytest.approx(last + PERIOD_NS / 1.001, abs=2)
    assert gaps[-1] == pytest.approx(last + 100 * PERIOD_NS / 1.001, abs=2)


@pytest.mark.parametrize("period_ns", [0, -1])
def test_a_timer_has_a_period(period_ns: int) -> None:
    with pytest.raises(ValueError, match=f"timer period is {period_ns} ns, must be positive"):
        Timer(Oscillator(0.0, 0), period_ns, 0)
    assert Timer(Oscillator(0.0, 0), 1, 0).next_ns() == 1


def test_a_fire_at_the_very_end_is_not_late() -> None:
    timer = Timer(Oscillator(0.0, 0), PERIOD_NS, latency_ns=0)
    start = timer.next_ns()
    assert timer.late(start, start + PERIOD_NS) == (start + PERIOD_NS, 0)
    assert timer.next_ns() == start + PERIOD_NS
