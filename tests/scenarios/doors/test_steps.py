"""Time that clients step: who is waited for, in which order frames enter, and what everybody is told."""

from typing import Any

import pytest

from bus.can import Frame
from scenarios.doors.steps import NODE, Steps
from tests.scenarios.doors.served import StubClient, stub_served

MS = 1_000_000
USAGE = "^join N \\[NAME\\] \\| listen \\| send ID#DATA \\| step 5ms$"


class Desk:
    """Steps over a stub network."""

    def __init__(self) -> None:
        self.served = stub_served()
        self.steps = Steps(self.served)

    def client(self) -> Any:
        return StubClient()

    def say(self, client: Any, line: str) -> str | None:
        return self.steps.take(client, line.split())

    def go(self, looks: int = 99) -> list[int]:
        """Run until it waits for words; the times of all looks, of which one too many ends it."""
        times: list[int] = []

        def look() -> bool:
            times.append(self.served.now_ns)
            return len(times) > looks

        self.steps.run(look, lambda timeout_s: timeout_s > 0.0)
        return times


@pytest.fixture
def desk() -> Desk:
    return Desk()


def test_time_stands_at_first_and_no_tick_is_late(desk: Desk) -> None:
    assert desk.served.pacer.paused and not desk.served.punctual.counting
    assert desk.served.nodes == [NODE] == [99]
    assert desk.steps.goal_ns() is None
    assert desk.go() == []


@pytest.mark.parametrize(
    "line", ["join", "join x", "join -1", "join 1 a b", "step", "listen to", "send", "dance"]
)
def test_another_line_is_refused_with_all_there_are(desk: Desk, line: str) -> None:
    with pytest.raises(ValueError, match=USAGE):
        desk.say(desk.client(), line)


@pytest.mark.parametrize("count", [0, 65])
def test_one_to_64_clients_can_be_waited_for(desk: Desk, count: int) -> None:
    with pytest.raises(ValueError, match=r"^join N: 1 to 64 clients$"):
        desk.say(desk.client(), f"join {count}")
    assert desk.say(desk.client(), "join 64") is None and desk.say(desk.client(), "join 1") is None


def test_two_clients_have_two_names(desk: Desk) -> None:
    one, other = desk.client(), desk.client()
    desk.say(one, "join 2 a")
    desk.say(one, "join 2 a")
    with pytest.raises(ValueError, match=r"^there is a client a already$"):
        desk.say(other, "join 2 a")
    desk.steps.leave(one)
    desk.steps.leave(one)
    assert desk.say(other, "join 1 a") is None


def test_who_joins_is_answered_when_all_are_there(desk: Desk) -> None:
    one, other = desk.client(), desk.client()
    desk.say(one, "join 2")
    assert desk.steps.waits(one) and not desk.steps.waits(other)
    assert desk.steps.goal_ns() is None and one.heard == []
    desk.say(other, "join 1")
    assert desk.steps.goal_ns() is None
    assert one.heard == other.heard == [b"ok\n"] and not desk.steps.waits(one)
    desk.steps.goal_ns()
    assert one.heard == [b"ok\n"]


def test_time_goes_as_far_as_the_shortest_step_once_everybody_has_stepped(desk: Desk) -> None:
    one, other = desk.client(), desk.client()
    for each in (one, other):
        desk.say(each, "join 2")
    desk.steps.goal_ns()
    desk.say(one, "step 7 ms")
    assert desk.steps.waits(one) and desk.steps.goal_ns() is None
    desk.say(other, "step 3ms")
    assert desk.steps.goal_ns() == 3 * MS
    desk.go()
    assert other.heard[-1] == b"ok 3000000\n" and one.heard == [b"ok\n"]
    desk.say(other, "step 10ms")
    desk.go()
    assert desk.served.now_ns == 7 * MS and one.heard[-1] == b"ok 7000000\n"
    assert not desk.steps.waits(one) and desk.steps.waits(other)


def test_doors_are_looked_at_at_each_tick_of_50_ms_and_at_the_end(desk: Desk) -> None:
    client = desk.client()
    desk.say(client, "step 120ms")
    assert desk.go() == [0, 50 * MS, 100 * MS, 120 * MS]
    assert not desk.served.entry.running


def test_a_span_is_in_ns(desk: Desk) -> None:
    desk.say(client := desk.client(), "step 100 s")
    assert desk.steps.goal_ns() == 100_000_000_000
    desk.steps.leave(client)


def test_a_step_of_nothing_is_answered_and_none_goes_back(desk: Desk) -> None:
    client = desk.client()
    desk.say(client, "step 0 s")
    assert desk.go() == [0] and client.heard == [b"ok 0\n"]
    with pytest.raises(ValueError, match=r"^time does not go back$"):
        desk.say(client, "step -1ms")


def test_it_is_over_in_the_middle_when_a_door_or_a_word_says_so(desk: Desk) -> None:
    client = desk.client()
    desk.say(client, "step 200ms")
    assert desk.go(looks=2) == [0, 50 * MS, 100 * MS] and client.heard == []
    desk.steps.run(lambda: False, lambda timeout_s: True)
    assert desk.served.now_ns == 150 * MS and client.heard == []


def test_what_doors_take_in_is_followed_by_another_look(desk: Desk) -> None:
    """The first two looks bring something; time goes on after one that brings nothing."""
    client, looked = desk.client(), []
    desk.say(client, "step 0 s")

    def look() -> bool:
        looked.append(desk.served.entry.count)
        if len(looked) < 3:
            desk.served.entry.count += 1
        return False

    desk.steps.run(look, lambda timeout_s: True)
    assert looked == [0, 1, 2]


def test_frames_enter_by_name_and_those_without_come_last(desk: Desk) -> None:
    first, second, third = (desk.client() for _ in range(3))
    desk.say(first, "send 001#01")
    desk.say(second, "join 3 b")
    desk.say(third, "join 3 a")
    desk.say(second, "send 002#02")
    desk.say(third, "send 003#03")
    desk.say(third, "send 004#")
    desk.steps.goal_ns()
    for each in (first, second, third):
        desk.say(each, "step 5ms")
    desk.go()
    identifiers = [(t_ns, node, frame.identifier) for t_ns, node, frame in desk.served.frames]
    assert identifiers == [(0, 99, 3), (0, 99, 4), (0, 99, 2), (0, 99, 1)]


def test_who_listens_has_every_frame_before_the_step_s_ok(desk: Desk) -> None:
    one, deaf = desk.client(), desk.client()
    assert desk.say(one, "listen") == "ok" and desk.say(one, "listen") == "ok"
    desk.say(deaf, "send 001#")
    assert len(desk.served.taps) == 1
    desk.served.taps[0](1_500_000, Frame(0x11, b"\x05"), "X")
    for each in (one, deaf):
        desk.say(each, "step 5ms")
    desk.go()
    text = one.heard[0].decode().splitlines()
    assert len(text) == 2 and text[0].startswith("(0.001500) ") and text[0].endswith(" 011#05")
    assert text[1] == "ok 5000000" and deaf.heard == [b"ok 5000000\n"]
    for each in (one, deaf):
        desk.say(each, "step 5ms")
    desk.go()
    assert one.heard[1:] == [b"ok 10000000\n"]  # what was told is not told again
