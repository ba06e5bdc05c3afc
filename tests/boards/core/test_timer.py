from itertools import pairwise

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
