"""The one door for work of many runs: a `concurrent.futures.Executor`, here or on a Dask cluster.

    for done in each(task, {"name": input, ...}.items(), jobs=2):
        done.key, done.value or done.error

A task is a function of a module and its input something that can be pickled. The same input gives the same
result, so a run that is lost with its worker is simply made again.
"""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent import futures
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

Input = TypeVar("Input")
Output = TypeVar("Output")
AHEAD = 3
"""Tasks handed out per worker: enough that none waits, few enough for the memory of a hundred thousand."""
_LOOK_S = 5.0
"""How often somebody looks whether the scheduler is still there."""
TRIES = 5
"""A task whose worker has died this often is taken to be the reason."""


@dataclass(frozen=True)
class Done(Generic[Output]):
    """A finished task: its value, or the error in one line. died: its workers did, and it never ended."""

    key: str
    value: Output | None
    error: str = ""
    died: bool = False


def each(
    task: Callable[[Input], Output],
    inputs: Iterable[tuple[str, Input]],
    *,
    jobs: int | None = None,
    scheduler: str | None = None,
) -> Iterator[Done[Output]]:
    """Run `task` on every (key, input) and give the results as they come.

    jobs: processes here (None: one per core; 1 still means a process of its own). scheduler: address of a
    Dask scheduler instead, such as tcp://host:8786. Inputs are drawn as workers become free. An exception of
    the task is an error of that key; a worker that dies costs its task another try. Leaving the loop early
    cancels what has not begun and ends the workers. A scheduler that is gone is a ConnectionError.
    """
    make, width, alive = _cluster(scheduler) if scheduler else _local(jobs)
    waiting = iter(inputs)
    lost: list[tuple[str, Input, int]] = []
    more = True
    while more or lost:
        running: dict[futures.Future[Output], tuple[str, Input, int]] = {}
        broken = False
        with make() as executor:
            while not broken:
                while len(running) < AHEAD * width and (more or lost):
                    item = lost.pop() if lost else next(((key, given, 1) for key, given in waiting), None)
                    if item is None:
                        more = False
                        continue
                    try:
                        running[executor.submit(task, item[1])] = item
                    except RuntimeError:  # the pool is broken, and says so to whoever comes next
                        lost.append(item)
                        broken = True
                        break
                if not running:
                    break
                ended = futures.wait(running, timeout=_LOOK_S, return_when=futures.FIRST_COMPLETED).done
                if not ended and not alive():  # its futures will never end
                    raise ConnectionError(f"the scheduler at {scheduler} is gone; what has ended is kept")
                for future in ended:
                    key, given, tried = running.pop(future)
                    try:
                        yield Done(key, future.result())
                    except Exception as error:
                        if not _lost(error):
                            yield Done(key, None, _line(error))
                        elif tried >= TRIES:
                            yield Done(key, None, f"the worker died {tried} times: {_line(error)}", died=True)
                        else:
                            lost.append((key, given, tried + 1))
                            broken = broken or isinstance(error, futures.BrokenExecutor)
        lost += [(key, given, tried + 1) for key, given, tried in running.values()]


def _lost(error: BaseException) -> bool:
    """Whether the worker is to blame, not the task. (Dask is not there to be asked for its class.)"""
    return (
        isinstance(error, futures.BrokenExecutor | futures.CancelledError)
        or type(error).__name__ == "KilledWorker"
    )


def _line(error: BaseException) -> str:
    return " ".join(f"{type(error).__name__}: {error}".split())


Maker = Callable[[], AbstractContextManager[futures.Executor]]
Alive = Callable[[], bool]


def _local(jobs: int | None) -> tuple[Maker, int, Alive]:
    """A process pool. Workers start afresh, inherit no threads or locks, and leave Ctrl-C to this process."""
    width = jobs or os.cpu_count() or 1

    @contextmanager
    def make() -> Iterator[futures.Executor]:
        before = set(multiprocessing.active_children())
        pool = futures.ProcessPoolExecutor(width, multiprocessing.get_context("spawn"), _worker)
        try:
            yield pool
        except BaseException:  # leaving early: what runs is lost, and made again by whoever goes on
            pool.shutdown(wait=False, cancel_futures=True)
            for process in set(multiprocessing.active_children()) - before:
                process.terminate()
            raise
        pool.shutdown()

    return make, width, lambda: True


def _worker() -> None:
    """In a new worker: Ctrl-C is the parent's, and one thread of BLAS leaves the cores to the others.

    It ends with its parent: nobody would take its result, and its queue never says so.
    """
    from threadpoolctl import threadpool_limits

    threading.Thread(target=_end_with_parent, daemon=True).start()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threadpool_limits(1)


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)  # at once: the main thread may be in the middle of a run


def _cluster(address: str) -> tuple[Maker, int, Alive]:
    from distributed import Client

    connect: Any = Client  # Dask has no types
    client = connect(address, timeout=20)
    client.wait_for_workers(1)
    width = max(1, sum(client.nthreads().values()))

    @contextmanager
    def make() -> Iterator[futures.Executor]:
        executor = client.get_executor(pure=False, retries=TRIES)
        try:
            yield executor
        finally:
            if alive():
                executor.shutdown(wait=False)

    def alive() -> bool:
        return bool(client.status != "closed")

    return make, width, alive
