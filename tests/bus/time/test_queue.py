from bisect import bisect_left

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.time import EventQueue, PastEventError
from bus.time.queue import _search


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


def test_a_queue_begins_at_nothing_and_empty() -> None:
    queue = EventQueue()
    assert (queue.now_ns, queue.next_ns(), len(queue)) == (0, None, 0)
    made: list[int] = []
    queue.at(0, made.append)
    queue.run_until(0)
    assert made == [0]


def test_time_does_not_turn_back() -> None:
    queue = EventQueue()
    queue.run_until(10)
    queue.run_until(3)
    assert queue.now_ns == 10


def test_a_call_that_fails_is_over_and_time_stands_there() -> None:
    queue = EventQueue()
    made: list[int] = []
    queue.at(5, lambda t_ns: [][t_ns])
    queue.at(7, made.append)
    with pytest.raises(IndexError):
        queue.run_until(10)
    assert (queue.now_ns, queue.next_ns(), len(queue)) == (5, 7, 1)
    queue.run_until(10)
    assert made == [7]


def test_who_stops_a_clock_takes_its_calls_out_in_order() -> None:
    queue = EventQueue()
    mine, others = list[int](), list[int]()
    stopped: list[int] = []

    def tick(t_ns: int) -> None:
        mine.append(t_ns)

    def stop(t_ns: int) -> None:
        """In the middle of a run, which goes on with what is left."""
        stopped.extend(when for when, call in queue.take_out(lambda call: call is tick))

    for t_ns in (7, 3, 9, 5):
        queue.at(t_ns, tick)
        queue.at(t_ns, others.append)
    queue.at(4, stop)
    queue.run_until(20)
    assert stopped == [5, 7, 9]
    assert (mine, others) == ([3], [3, 5, 7, 9])
    assert queue.take_out(lambda _: True) == []


@given(st.lists(st.integers(-5, 5)).map(sorted), st.integers(-6, 6))
def test_compiled_code_finds_the_place_that_bisect_finds(before: list[int], key: int) -> None:
    assert _search(before, key) == bisect_left(before, key)
