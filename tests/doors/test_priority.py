"""Real-time priority of `serve`: ticks before ordinary programs, children not, what is not granted."""

import os
import subprocess
import sys
import threading
from pathlib import Path
from typing import NoReturn

import pytest

from scenarios.doors.loop import first
from tests.doors.process import PROGRAM
from tests.ports import free_ports

ASK = "import os; print(os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK)"


def scheduler() -> int:
    return os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK


def test_the_ticks_are_first_and_their_children_ordinary_and_afterwards_all_is_as_before() -> None:
    before = scheduler()
    try:
        with first():
            assert scheduler() == os.SCHED_RR
            child = subprocess.run([sys.executable, "-c", ASK], capture_output=True, text=True, check=True)
            assert int(child.stdout) == os.SCHED_OTHER
    except OSError as error:
        pytest.skip(str(error))
    assert scheduler() == before


def test_a_doors_thread_is_lifted_too_and_let_down_again() -> None:
    """It may hold Python's lock when a tick is due."""
    wait, up = threading.Event(), threading.Event()
    thread = threading.Thread(target=lambda: (up.set(), wait.wait()))
    thread.start()
    up.wait()
    assert thread.native_id is not None
    try:
        with first():
            assert os.sched_getscheduler(thread.native_id) & ~os.SCHED_RESET_ON_FORK == os.SCHED_RR
        assert os.sched_getscheduler(thread.native_id) == os.SCHED_OTHER
    except OSError as error:
        pytest.skip(str(error))
    finally:
        wait.set()
        thread.join()


def test_what_the_system_does_not_grant_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_arguments: object) -> NoReturn:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    with pytest.raises(OSError, match="not granted; run as root"), first():
        pass
    with first(asked=False) as said:
        assert said.startswith("ticks run among other programs") and "ulimit -r 1" in said
        assert "\n" not in said


def test_a_system_without_the_class_runs_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(os, "sched_setscheduler")
    with pytest.raises(OSError, match="has no real-time scheduling"), first():
        pass
    with first(asked=False) as said:
        assert "among other programs" in said


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ((), "ticks run"),
        (("--no-realtime",), None),
        (("--speed", "2"), None),
        (("--clock", "steps", "--control", "{port}"), None),
    ],
)
def test_serve_takes_it_by_itself_at_the_walls_pace_and_says_so(
    tmp_path: Path, words: tuple[str, ...], expected: str | None
) -> None:
    given = [word.format(port=free_ports()) for word in words]
    line = [sys.executable, "-c", PROGRAM, "serve", "--can", "virtual:priority", "--duration", "0.2", *given]
    done = subprocess.run(line, cwd=tmp_path, capture_output=True, text=True, check=True, timeout=120)
    assert ("ticks run" in done.stdout) == (expected is not None), done.stdout
