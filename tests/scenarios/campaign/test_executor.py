"""The door for many runs: results, errors, dead workers, and leaving early."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

import pytest

from scenarios.campaign import executor
from scenarios.campaign.executor import each


def double(number: int) -> int:
    if number < 0:
        raise ValueError("no negative\nnumbers")
    return 2 * number


def die_once(given: tuple[str, int]) -> int:
    """Kills its own process the first time it sees a number that divides by five."""
    folder, number = given
    mark = Path(folder) / str(number)
    if number % 5 == 0 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def die(_: int) -> int:
    os.kill(os.getpid(), signal.SIGKILL)
    return 0


class _Silent(Executor):
    """Takes everything and answers nothing, as a client does whose scheduler was killed."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        return Future()


def test_a_scheduler_that_is_gone_ends_it_with_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(executor, "_LOOK_S", 0.05)
    looks = iter([True, True])
    monkeypatch.setattr(executor, "_cluster", lambda _address: (_Silent, 1, lambda: next(looks, False)))
    with pytest.raises(ConnectionError, match="scheduler at tcp://gone:1 is gone; what has ended is kept"):
        list(each(double, [("1", 1)], scheduler="tcp://gone:1"))
    assert next(looks, None) is None  # it was waited for as long as it was there


def test_every_key_gets_its_own_answer_or_its_own_error() -> None:
    found = {done.key: done for done in each(double, ((str(n), n) for n in (3, -1, 0)), jobs=1)}
    assert {key: done.value for key, done in found.items()} == {"3": 6, "-1": None, "0": 0}
    assert found["-1"].error == "ValueError: no negative numbers"
    assert not found["3"].error


@pytest.mark.long
def test_a_dead_worker_costs_nothing_but_another_try(tmp_path: Path) -> None:
    inputs = [(str(n), (str(tmp_path), n)) for n in range(12)]
    found = {done.key: (done.value, done.error) for done in each(die_once, inputs, jobs=2)}
    assert found == {str(n): (n, "") for n in range(12)}


@pytest.mark.long
def test_a_task_that_always_kills_its_worker_is_given_up() -> None:
    (done,) = each(die, [("deadly", 0)], jobs=1)
    assert done.value is None
    assert "died" in done.error


def sleep(given: str) -> None:
    """Says which process it is, then works on for longer than any test."""
    (Path(given) / str(os.getpid())).touch()
    time.sleep(600)


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="looks at processes in /proc")
def test_workers_end_with_a_parent_that_is_killed(tmp_path: Path) -> None:
    program = (
        "from scenarios.campaign.executor import each\n"
        "from tests.scenarios.campaign.test_executor import sleep\n"
        f"if __name__ == '__main__':\n    list(each(sleep, [('one', {str(tmp_path)!r})], jobs=1))\n"
    )
    (tmp_path / "parent.py").write_text(program)
    root = str(Path(__file__).parents[3])
    environment = {**os.environ, "PYTHONPATH": root}
    with subprocess.Popen([sys.executable, tmp_path / "parent.py"], env=environment) as parent:
        found: list[Path] = []
        end = time.monotonic() + 60
        while not found and time.monotonic() < end:
            time.sleep(0.05)
            found = [path for path in tmp_path.iterdir() if path.name.isdecimal()]
        parent.kill()
    (worker,) = found
    end = time.monotonic() + 20
    while time.monotonic() < end and _runs(worker.name):
        time.sleep(0.05)
    assert not _runs(worker.name)


def _runs(process: str) -> bool:
    """Whether a process is there and no zombie."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_inputs_are_drawn_as_they_are_needed() -> None:
    drawn = []

    def endless() -> Iterator[tuple[str, int]]:
        number = 0
        while True:
            drawn.append(number)
            yield str(number), number
            number += 1

    results = each(double, endless(), jobs=1)
    first = next(results)  # whichever is done first
    assert first.value == 2 * int(first.key)
    results.close()  # type: ignore[attr-defined]
    assert len(drawn) < 20
