"""When a step starts, ends, waits in vain or is given up; ticks are whole seconds, and a step ends in one."""

import itertools
from collections.abc import Generator
from types import SimpleNamespace
from typing import Any

import pytest

from bus.protocol import Device, MotionFlag, Opcode
from scenarios.native.finder import compiled
from tests.scenarios.language.desk import Desk, Night

pytestmark = pytest.mark.skipif(compiled(), reason="no class of a test may derive from a compiled one")

STILL = SimpleNamespace(velocity=0, flags=0)
MOVING = SimpleNamespace(velocity=1, flags=0)
POWERED = SimpleNamespace(velocity=0, flags=int(MotionFlag.POWERED))
RA, DEC = Device.AXIS_RA, Device.AXIS_DEC


def test_a_step_starts_in_the_tick_behind_the_last_ones_end() -> None:
    night = Night("wait: {for: 2 s}", "wait: {for: 1 s}")
    assert not night.run(3).programme.finished
    assert night.times == [(0, 2), (3, None)]
    assert night.run(4).programme.finished and not night.programme.failed
    assert night.times == [(0, 2), (3, 4)]
    assert night.logs.said == [
        "0 HOST step 'wait 1' starts", "2 HOST step 'wait 1' is done",
        "3 HOST step 'wait 2' starts", "4 HOST step 'wait 2' is done",
    ]  # fmt: skip


@pytest.mark.parametrize(("steps", "times"), [
    (["wait: {for: 1 s}, at: 4 s"], [(4, 5)]),
    (["wait: {for: 1 s}, delay: 2 s"], [(2, 3)]),
    (["wait: {for: 1 s}", "wait: {for: 1 s}, delay: 2 s"], [(0, 1), (4, 5)]),
    (["wait: {for: 1 s}, at: 1 s, delay: 2 s"], [(3, 4)]),
    (["wait: {for: 2 s}, name: a", "wait: {for: 5 s}", "wait: {for: 1 s}, after: a"],
     [(0, 2), (3, 8), (3, 4)]),
    (["wait: {for: 2 s}, name: a", "wait: {for: 9 s}, after: a", "wait: {for: 1 s}"],
     [(0, 2), (3, 12), (3, 4)]),
    (["wait: {for: 1 s}, name: a", "wait: {for: 1 s}, at: 4 s", "wait: {for: 1 s}, after: a"],
     [(0, 1), (4, 5), (2, 3)]),
    (["wait: {for: 1 s}, at: 8 s", "wait: {for: 1 s}"], [(8, 9), (10, 11)]),
    (["wait: {for: 1 s}, name: a", "wait: {for: 3 s}, name: b, after: a", "wait: {for: 1 s}, after: b"],
     [(0, 1), (2, 5), (6, 7)]),
])  # fmt: skip
def test_conditions_of_a_start(steps: list[str], times: list[tuple[int, int]]) -> None:
    night = Night(*steps).run(12)
    assert night.times == times and night.programme.finished


@pytest.mark.parametrize(("word", "motions", "holds"), [
    ("powered", (POWERED, POWERED), True), ("powered", (POWERED, STILL), False), ("powered", (), False),
    ("stopped", (STILL, STILL), True), ("stopped", (STILL, MOVING), False), ("stopped", (), False),
    ("stopped", (MOVING, STILL), False), ("on_target", (), False), ("tracking", (), False),
])  # fmt: skip
def test_a_condition_is_of_both_axes(word: str, motions: tuple[Any, ...], holds: bool) -> None:
    desk = Desk()
    desk.motions = dict(zip((RA, DEC), motions, strict=False))
    assert Night(f"wait: {{for: 1 s}}, when: {word}", desk=desk).run(0).times == [
        (0 if holds else None, None)
    ]


@pytest.mark.parametrize("word", ["on_target", "tracking"])
def test_conditions_of_the_star_are_the_pointings(word: str) -> None:
    night = Night(f"wait: {{for: 1 s}}, when: {word}").run(1)
    setattr(night.programme.pointing, word, True)
    assert night.run(3).times == [(2, 3)]


def test_a_condition_that_does_not_come_ends_at_its_timeout() -> None:
    """It counts from when the step might start but for its condition: a second, and more than two."""
    night = Night("wait: {for: 1 s}, at: 1 s, when: stopped, timeout: 2 s").run(3)
    assert not night.programme.finished
    assert night.run(4).programme.finished and night.programme.failed
    (record,) = night.programme.records
    assert (record.start_s, record.end_s, record.failed) == (None, 4.0, "not stopped within 2 s")
    assert night.logs.errors == ["4 HOST step 'wait 1' failed: not stopped within 2 s"]


def test_a_step_that_has_not_its_turn_is_not_late() -> None:
    night = Night("wait: {for: 6 s}", "wait: {for: 1 s}, timeout: 2 s").run(8)
    assert night.programme.finished and not night.programme.failed


def test_the_wait_for_a_condition_is_of_the_timeout() -> None:
    desk = Desk()
    night = Night("wait: {for: 3 s}, when: stopped, timeout: 4 s", desk=desk).run(1)
    desk.motions = {RA: STILL, DEC: STILL}
    assert not night.run(4).programme.failed
    assert night.run(5).times == [(2, 5)] and not night.programme.failed


def test_a_step_that_takes_too_long_fails_and_others_are_given_up() -> None:
    night = Night(
        "wait: {for: 1 s}, name: a", "wait: {for: 9 s}, after: a",
        "wait: {for: 8 s}, timeout: 4 s", "wait: {for: 1 s}",
    )  # fmt: skip
    assert not night.run(6).programme.failed
    night.run(7)
    assert [each.failed for each in night.programme.records] == [
        "", "given up", "not done within 4 s", ""
    ]  # fmt: skip
    assert night.times == [(0, 1), (2, 7), (2, 7), (None, None)]
    assert night.logs.errors == ["7 HOST step 'wait 3' failed: not done within 4 s"]


def test_after_a_failure_both_axes_are_stopped_once() -> None:
    night = Night("wait: {for: 1 s}, when: stopped, timeout: 1 s").run(2)
    assert night.programme.failed and night.desk.asked == []
    night.run(9)
    assert night.desk.asked == [(RA, Opcode.STOP), (DEC, Opcode.STOP)]


def test_a_board_that_does_not_stop_ends_nothing() -> None:
    desk = Desk()
    desk.refuses = True
    night = Night("stop: {}", "wait: {for: 1 s}", desk=desk).run(0)
    assert night.programme.records[0].failed == "no" and night.times[0] == (0, 0)
    assert night.logs.errors == ["0 HOST step 'stop 1' failed: no"]
    assert night.run(3).times[1] == (None, None)


def test_a_failure_ends_what_runs_beside_it() -> None:
    night, ended = Night("wait: {for: 9 s}, timeout: 2 s"), []

    def procedure() -> Generator[None, None, None]:
        try:
            yield from itertools.repeat(None)
        finally:
            ended.append(night.programme.failed)

    night.programme._running[7] = procedure()
    night.programme.records += [night.programme.records[0]] * 7
    night.run(3)
    assert night.programme.failed and ended == [True]
