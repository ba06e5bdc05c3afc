"""The thread in which doors for other programs live: one asyncio loop, away from the ticking thread.

Sockets, HTTP and browsers wait, block and break on wall time. None of it may hold up a tick, and nothing a
tick does may depend on it. Commands go through `Telescope.call`, readings come from its snapshot.
"""

from __future__ import annotations

import asyncio
import re
import sys
import threading
from collections.abc import Coroutine
from concurrent.futures import Future
from contextlib import suppress
from typing import Any, TypeVar

T = TypeVar("T")
_CLOSE_S = 0.3
"""Time the doors get to say goodbye; serve has to end within a second. ASSUMPTION."""
_SWITCH_S = 0.0005
"""How long the ticking thread waits for Python's lock at most; the default of 5 ms would make ticks late."""

HEAD_BYTES = 8
"""The longest method word of HTTP and the space behind it."""
_METHOD = re.compile(rb"(GET|HEAD|POST|PUT|DELETE|CONNECT|OPTIONS|TRACE|PATCH) ")


def is_http(head: bytes) -> bool:
    """Whether a stream that begins with `head`, its first `HEAD_BYTES`, is an HTTP request. A web page may
    send one to any port."""
    return _METHOD.match(head) is not None


class Service:
    """Something that runs until it is cancelled, or breaks."""

    def __init__(self, outside: Outside, task: asyncio.Task[Any]) -> None:
        self._outside = outside
        self._task = task

    def check(self) -> None:
        """Raise OSError when it has ended."""
        if self._task.done():
            error = None if self._task.cancelled() else self._task.exception()
            raise OSError(" ".join(str(error or "closed").split()))

    def cancel(self) -> None:
        """End it."""
        self._outside.end([self._task])


class Outside:
    """An asyncio loop in a thread of its own, for as long as the doors are open."""

    def __init__(self) -> None:
        sys.setswitchinterval(_SWITCH_S)
        self._loop = asyncio.new_event_loop()
        # of tasks that nobody waited for, such as a library's after a client broke off
        self._loop.set_exception_handler(lambda _loop, _context: None)
        self._thread = threading.Thread(target=self._loop.run_forever, name="outside", daemon=True)
        self._thread.start()

    def run(self, work: Coroutine[Any, Any, T], timeout_s: float | None = None) -> T:
        """Run something short to its end, such as opening a port; raises what it raises."""
        future: Future[T] = asyncio.run_coroutine_threadsafe(work, self._loop)
        return future.result(timeout_s)

    def keep(self, work: Coroutine[Any, Any, object]) -> Service:
        """Run something until it is cancelled; raises what it raises before it first waits."""
        return Service(self, self.run(self._keep(work)))

    def end(self, tasks: list[asyncio.Task[Any]] | None = None) -> None:
        """Cancel tasks, or all, and wait a moment for them."""
        if not self._loop.is_closed():
            with suppress(TimeoutError):
                self.run(self._cancel(tasks), 2 * _CLOSE_S)

    def close(self) -> None:
        """Cancel what runs and end the thread; twice does nothing."""
        if self._loop.is_closed():
            return
        self.end()
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(_CLOSE_S)
        if not self._thread.is_alive():
            self._loop.close()

    async def _keep(self, work: Coroutine[Any, Any, object]) -> asyncio.Task[object]:
        task = asyncio.ensure_future(work)
        await asyncio.sleep(0)
        if task.done():
            task.result()
        return task

    async def _cancel(self, tasks: list[asyncio.Task[Any]] | None) -> None:
        if tasks is None:
            tasks = [task for task in asyncio.all_tasks() if task is not asyncio.current_task()]
        for task in tasks:
            task.cancel()
        if tasks:
            await asyncio.wait(tasks, timeout=_CLOSE_S)
