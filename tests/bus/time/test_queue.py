import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.time import EventQueue, PastEventError


@given(st.lists(st.integers(0, 50)))
def test_calls_come_in_order_of_time_then_of_asking(times: list[int]) -> None:
    queue = EventQueue()
    made: list[tuple[int, int]] = []
    for number, t_ns in enumerate(times):
        queue.at(t_ns, lambda now, number=number: made.append((now, number)))
    queue.run_until(50)
    assert made == sorted(made)
    assert [number for _, number in made] == [n for _, n in sorted((t, n) for n, t in enumerate(times))]


def test_a_call_may_ask_for_another_at_the_same_time() -> None:
    queue = EventQueue()
    made: list[str] = []
    queue.at(5, lambda t: (made.append("first"), queue.at(t, lambda _: made.append("third")))[0])
    queue.at(5, lambda _: made.append("second"))
    queue.run_until(5)
    assert made == ["first", "second", "third"]


def test_run_until_stops_there_and_moves_the_clock() -> None:
    queue = EventQueue()
    queue.at(11, lambda _: pytest.fail("not due"))
    queue.run_until(10)
    assert queue.now_ns == 10
    assert queue.next_ns() == 11
    assert len(queue) == 1


def test_the_past_is_refused() -> None:
    queue = EventQueue()
    queue.run_until(10)
    with pytest.raises(PastEventError, match="9 ns lies before the present, 10 ns"):
        queue.at(9, lambda _: None)
