"""What becomes of tasks whose workers die, and how the two kinds of pools are made and left."""

import multiprocessing
import os
import queue
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent import futures
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from scenarios.campaign import executor
from scenarios.campaign.executor import Done, each

Played = Callable[[str], str | Exception | None]
"""What a pool makes of an input: a result, an error, or nothing for as long as it is there."""


class KilledWorker(Exception):
    """As Dask's, which is not there."""


class Pool(Executor):
    """Answers at once, or never."""

    def __init__(self, played: Played) -> None:
        self.played = played
        self.held: dict[str, Future[Any]] = {}

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future = self.held[args[0]] = Future[Any]()
        answer = self.played(args[0])
        if isinstance(answer, Exception):
            future.set_exception(answer)
        elif answer is not None:
            future.set_result(answer)
        return future


class Bench:
    """Pools by the script, `each` over them, and what is asked where nothing ends."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, played: Played, width: int = 1) -> None:
        self.pools: list[Pool] = []
        self.alive: Callable[[], bool] = lambda: False
        monkeypatch.setattr(executor, "_LOOK_S", 0.0)
        monkeypatch.setattr(executor, "_local", lambda _jobs: (self.make, width, lambda: self.alive()))
        self.played = played

    def make(self) -> Pool:
        self.pools.append(Pool(self.played))
        return self.pools[-1]

    def each(self, keys: str) -> Iterator[Done[str]]:
        return each(str, ((key, key) for key in keys))


def test_three_tasks_are_handed_out_per_worker(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = Bench(monkeypatch, lambda _: None, width=2)
    with pytest.raises(ConnectionError):
        list(bench.each("abcdefghij"))
    assert len(bench.pools[0].held) == 6


@pytest.mark.parametrize(("error", "pools"), [
    (BrokenExecutor("gone"), 2), (CancelledError(), 1), (KilledWorker("gone"), 1)
])  # fmt: skip
def test_a_dead_worker_costs_another_try(
    error: Exception, pools: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A pool of processes is broken with its worker; a cluster stays."""
    answers: list[str | Exception] = ["good", error]
    bench = Bench(monkeypatch, lambda _: answers.pop())
    assert list(bench.each("a")) == [Done("a", "good", "", died=False)]
    assert len(bench.pools) == pools


def test_an_error_of_the_task_is_no_dead_worker(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = Bench(monkeypatch, {"a": ValueError("a")}.get)
    assert list(bench.each("a")) == [Done("a", None, "ValueError: a", died=False)]


def test_a_task_is_given_up_with_its_fifth_worker(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = Bench(monkeypatch, lambda _: BrokenExecutor("gone"))
    assert list(bench.each("a")) == [
        Done("a", None, "the worker died 5 times: BrokenExecutor: gone", died=True)
    ]
    assert len(bench.pools) == 5


def test_what_was_running_beside_it_has_lost_a_worker_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """b runs beside a in five pools. The fifth breaks under it, when a is given up."""
    dead: dict[str, str | Exception | None] = {"a": BrokenExecutor("a")}
    bench = Bench(monkeypatch, dead.get)

    def alive() -> bool:
        bench.pools[-1].held["b"].set_exception(BrokenExecutor("b"))
        return True

    bench.alive = alive
    assert [done.error for done in bench.each("ab")] == [
        f"the worker died 5 times: BrokenExecutor: {key}" for key in "ab"
    ]
    assert len(bench.pools) == 5


def test_a_pool_that_takes_nothing_is_left_and_its_tasks_are_made_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def played(key: str) -> str | None:
        if len(bench.pools) == 2:
            return key
        if key == "b":
            raise RuntimeError("broken")
        return None

    bench, asked = Bench(monkeypatch, played), list[int]()

    def alive() -> bool:
        asked.append(1)
        return len(asked) == 1

    bench.alive = alive
    assert {done.key: done.value for done in bench.each("ab")} == {"a": "a", "b": "b"}
    assert len(bench.pools) == 2


class Processes:
    """A pool of processes that starts none, and writes down how it was made and left."""

    def __init__(self, width: int, context: Any, initializer: Any) -> None:
        self.made = width, context.get_start_method(), initializer
        self.left: list[dict[str, bool]] = []

    def shutdown(self, **how: bool) -> None:
        self.left.append(how)


@pytest.mark.parametrize(("jobs", "cores", "width"), [(3, 8, 3), (None, 8, 8), (None, None, 1)])
def test_a_pool_has_a_process_per_job_or_core(
    jobs: int | None, cores: int | None, width: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "cpu_count", lambda: cores)
    monkeypatch.setattr(futures, "ProcessPoolExecutor", Processes)
    make, found, alive = executor._local(jobs)
    with make() as pool:
        assert isinstance(pool, Processes) and pool.left == []
    assert (found, alive()) == (width, True)
    assert pool.made == (width, "spawn", executor._worker)
    assert pool.left == [{}]  # what runs is waited for


def test_leaving_early_ends_the_pools_processes_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    ended: list[str] = []
    found = iter([["other"], ["own", "other"]])

    class Child(str):
        """A process by its name."""

        def terminate(self) -> None:
            ended.append(self)

    monkeypatch.setattr(multiprocessing, "active_children", lambda: [Child(name) for name in next(found)])
    monkeypatch.setattr(futures, "ProcessPoolExecutor", Processes)
    make, _, _ = executor._local(1)
    with pytest.raises(GeneratorExit), make() as pool:
        raise GeneratorExit
    assert isinstance(pool, Processes)
    assert pool.left == [{"wait": False, "cancel_futures": True}] and ended == ["own"]


def test_a_worker_leaves_interrupts_and_cores_to_others(monkeypatch: pytest.MonkeyPatch) -> None:
    threads: queue.Queue[bool] = queue.Queue()
    np.linalg.inv(np.eye(2))  # BLAS is there
    monkeypatch.setattr(
        executor, "_end_with_parent", lambda: threads.put(threading.current_thread().daemon)
    )
    before = signal.getsignal(signal.SIGINT)
    try:
        with threadpool_limits(2):
            executor._worker()
            assert {each["num_threads"] for each in threadpool_info() if each["user_api"] == "blas"} == {1}
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)
    assert threads.get(timeout=10) is True  # a thread that would not keep the worker


def test_a_worker_ends_at_once_when_its_parent_has(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[Any] = []
    parent = SimpleNamespace(join=lambda: told.append("parent"))
    monkeypatch.setattr(os, "_exit", told.append)
    monkeypatch.setattr(multiprocessing, "parent_process", lambda: None)
    executor._end_with_parent()
    assert told == []
    monkeypatch.setattr(multiprocessing, "parent_process", lambda: parent)
    executor._end_with_parent()
    assert told == ["parent", 1]


class Client:
    """A Dask client that has these threads by worker, and tells what it was asked."""

    threads: dict[str, int]

    def __init__(self, address: str, timeout: int) -> None:
        self.told: list[Any] = [(address, timeout)]
        self.status = "running"
        CLIENTS.append(self)

    def wait_for_workers(self, count: int) -> None:
        self.told.append(count)

    def nthreads(self) -> dict[str, int]:
        return self.threads

    def get_executor(self, pure: bool, retries: int) -> Any:
        self.told.append((pure, retries))
        return SimpleNamespace(shutdown=lambda wait: self.told.append(("shutdown", wait)))


CLIENTS: list[Client] = []


@pytest.mark.parametrize(("threads", "width"), [({}, 1), ({"one": 2, "two": 3}, 5)])
@pytest.mark.parametrize("gone", [False, True])
def test_a_cluster_is_as_wide_as_its_threads(
    threads: dict[str, int], width: int, gone: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is waited for a worker; a scheduler that has gone is told nothing more."""
    monkeypatch.setattr(Client, "threads", threads, raising=False)
    monkeypatch.setitem(sys.modules, "distributed", SimpleNamespace(Client=Client))
    make, found, alive = executor._cluster("tcp://here:1")
    client = CLIENTS.pop()
    assert alive() and found == width
    with make():
        client.status = "closed" if gone else "running"
    assert alive() is not gone
    left = [] if gone else [("shutdown", False)]
    assert client.told == [("tcp://here:1", 20), 1, (False, 5), *left]
