"""The serving loop over stubs: what is said each second, and when it is over."""

from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.doors import loop
from scenarios.doors.loop import Loop
from tests.scenarios.doors.served import stub_served

S = 1_000_000_000
TEXT = "0.0 s simulated, bus load 25.0%, no input"


class Desk:
    """A loop whose clock a test sets, s."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, duration_s: float | None = None) -> None:
        self.clock, self.shown, self.said = 100.0, list[str](), list[str]()
        self.polled: list[int] = []
        self.flushed: list[float] = []
        self.served = stub_served()
        self.served.pacer.slips, self.served.pacer.slipped_s = 0, 0.0
        self.steps: list[Any] = []
        self.served.pacer.run = lambda each_slice: self.steps.append(each_slice)
        monkeypatch.setattr(loop, "perf_counter", lambda: self.clock)
        monkeypatch.setattr(
            loop, "gc", SimpleNamespace(collect=lambda: 0, freeze=lambda: 0, unfreeze=lambda: 0)
        )
        keeper: Any = SimpleNamespace(door=None, poll=self.polled.append)
        console: Any = SimpleNamespace(print=self.said.append)
        recording: Any = SimpleNamespace(flush=lambda: self.flushed.append(self.clock))
        self.loop: Any = Loop(self.served, [keeper], console, self.shown.append, duration_s, recording)
        self.loop.run()

    def slice(self, clock: float) -> bool:
        self.clock = clock
        over: bool = self.loop._slice()
        return over


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(monkeypatch)


def test_at_its_end_nothing_runs_or_counts_and_its_time_stands(desk: Desk) -> None:
    assert desk.steps == [desk.loop._slice]
    assert not desk.served.entry.running and not desk.served.punctual.counting
    desk.served.now_ns = 9 * S
    assert desk.loop.text() == "9.0 s simulated, bus load 25.0%, no input"
    desk.loop._end_ns = 2 * S
    assert desk.loop.text().startswith("2.0 s simulated")


def test_doors_are_looked_at_with_the_present_time(desk: Desk) -> None:
    desk.served.now_ns = 7
    assert not desk.slice(100.1)
    assert desk.polled == [7] and desk.served.entry.running


def test_a_line_is_shown_each_second_and_logs_half_a_second_later(desk: Desk) -> None:
    for clock in (100.99, 101.0, 101.5, 101.99, 102.0, 102.4, 102.5):
        desk.slice(clock)
    assert len(desk.shown) == 2 and desk.flushed == [101.5, 102.5]
    assert desk.shown[0] == TEXT + ", 0.00 times real time"
    desk.served.pacer.paused = True
    desk.slice(103.0)
    assert desk.shown[-1] == TEXT + ", paused"


def test_the_pace_is_simulated_over_wall_time_of_the_last_second(desk: Desk) -> None:
    desk.served.now_ns = 3 * S
    desk.slice(101.5)
    desk.served.now_ns = 4 * S
    desk.slice(103.5)
    assert [line.rpartition(", ")[2] for line in desk.shown] == [
        "2.00 times real time",
        "0.50 times real time",
    ]


def test_a_slow_machine_is_said_once_and_that_it_keeps_up_again(desk: Desk) -> None:
    pacer = desk.served.pacer
    pacer.speed = 2.5
    for clock, slips in ((101.0, 1), (102.0, 2), (103.0, 2), (104.0, 2), (105.0, 3)):
        pacer.slips = slips
        desk.served.now_ns += S
        desk.slice(clock)
    slow = (
        "this machine cannot keep up: 1.00 of 2.5 times real time. Time runs slower. "
        "Boards lose no frame. What clients send too fast is refused and counted."
    )
    assert desk.said == [slow, "keeping up again at 1.00 times real time", slow]
    pacer.slipped_s = 1.25
    desk.served.entry.count = 4
    desk.loop._end_ns = 6 * S
    assert desk.loop.text() == (
        "6.0 s simulated, 1.2 s given up on a machine too slow, bus load 25.0%, 4 inputs"
    )


def test_it_is_over_after_its_duration_or_when_it_was_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    desk = Desk(monkeypatch, 2.0)
    assert not desk.slice(101.9) and desk.slice(102.0)
    endless = Desk(monkeypatch)
    assert not endless.slice(1e9)
    endless.served.ending = True
    assert endless.slice(100.0)


def test_where_clients_step_time_the_control_plane_is_waited_at(monkeypatch: pytest.MonkeyPatch) -> None:
    desk = Desk(monkeypatch, 5.0)
    waited: list[float] = []
    plane: Any = SimpleNamespace(wait=waited.append)
    monkeypatch.setattr(loop, "ControlDoor", SimpleNamespace)
    polled: list[int] = []
    keeper: Any = SimpleNamespace(door=plane, poll=polled.append)
    ran: list[Any] = []
    desk.served.steps = SimpleNamespace(run=lambda *each: ran.append(each))
    desk.loop.keepers = [*desk.loop.keepers, keeper]
    desk.loop.run()
    assert ran == [(desk.loop._slice, desk.loop._wait)] and len(desk.steps) == 1
    desk.served.now_ns = 8
    assert not desk.loop._wait(0.5)
    assert waited == [0.5] and polled == [8] and desk.polled == []
    desk.slice(100.1)
    assert polled == [8] and desk.polled == [8]
    desk.clock = 105.0
    assert desk.loop._wait(0.0)
