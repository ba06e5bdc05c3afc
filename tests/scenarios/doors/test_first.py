"""Threads of the serving process before other programs: lifted, put back, and what is said without it."""

import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.doors import loop
from scenarios.doors.loop import AHEAD, NOT_GRANTED, first


class Scheduler:
    """The system's calls; granted: whether it allows a real-time class."""

    SCHED_RR, SCHED_RESET_ON_FORK = 2, 0x4000_0000

    def __init__(self, granted: bool = True) -> None:
        self.granted = granted
        self.calls: list[tuple[int, int, int]] = []

    def sched_param(self, priority: int) -> int:
        return priority

    def sched_getscheduler(self, thread: int) -> int:
        if thread == 9:
            raise ProcessLookupError
        return 3 | self.SCHED_RESET_ON_FORK

    def sched_setscheduler(self, thread: int, policy: int, priority: int) -> None:
        if priority and not self.granted:
            raise PermissionError
        self.calls.append((thread, policy, priority))


@pytest.fixture
def threads(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    for name in ("7", "9"):
        (tmp_path / name).touch()
    monkeypatch.setattr(loop, "_THREADS", tmp_path)
    return tmp_path


def test_all_threads_go_first_and_are_as_they_were(monkeypatch: pytest.MonkeyPatch, threads: Path) -> None:
    system = Scheduler()
    monkeypatch.setattr(loop, "os", system)
    with first() as said:
        assert said == AHEAD == "ticks run before other programs, as the system allows it"
        assert system.calls == [(7, 2 | 0x4000_0000, 1)]
    assert system.calls[1:] == [(7, 3, 0)]
    monkeypatch.setattr(loop, "_THREADS", threads / "none")
    with first():
        assert system.calls[2][0] == 0  # the process itself


def test_what_is_not_granted_is_an_error_if_it_was_asked_for(
    monkeypatch: pytest.MonkeyPatch, threads: Path
) -> None:
    system = Scheduler(granted=False)
    monkeypatch.setattr(loop, "os", system)
    with (
        pytest.raises(
            OSError, match=r"^--realtime: not granted; run as root, or give the user an rtprio limit "
        ),
        first(),
    ):
        pass
    with first(asked=False) as said:
        assert said == f"ticks run among other programs; if busy ones make them late, {NOT_GRANTED}"
    assert system.calls == []


def test_a_thread_that_was_lifted_is_put_back_if_the_next_is_not(
    monkeypatch: pytest.MonkeyPatch, threads: Path
) -> None:
    system: Any = Scheduler()
    lift = system.sched_setscheduler

    def once(thread: int, policy: int, priority: int) -> None:
        lift(thread, policy, priority)
        system.granted = False

    system.sched_setscheduler = once
    (threads / "9").rename(threads / "11")
    monkeypatch.setattr(loop, "os", system)
    with first(asked=False):
        lifted = [thread for thread, _, priority in system.calls if priority]
        assert len(lifted) == 1 and system.calls[1:] == [(lifted[0], 3, 0)]


def test_a_system_without_such_a_class_is_said(monkeypatch: pytest.MonkeyPatch, threads: Path) -> None:
    monkeypatch.setattr(loop, "os", SimpleNamespace(name=os.name))
    with (
        pytest.raises(OSError, match=r"^--realtime: this system has no real-time scheduling for programs$"),
        first(),
    ):
        pass
    with first(asked=False) as said:
        assert said == "ticks run among other programs; busy ones make them late, so end those"
