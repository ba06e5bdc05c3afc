"""The thread in which doors for other programs live: one asyncio loop, away from the ticking thread.

Sockets, HTTP and browsers wait, block and break on wall time. None of it may hold up a tick, and nothing a
tick does may depend on it: commands go through `Telescope.call`, readings come from its snapshot.
"""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Coroutine
from typing import Any, TypeVar

T = TypeVar("T")
_CLOSE_S = 1.0
"""Time the doors get to say goodbye. ASSUMPTION."""


class Outside:
    """An asyncio loop in a thread of its own, for as long as the doors are open."""

    def __init__(self) -> None:
        self._loop = asyncio.new_event_loop()
        self._tasks: set[asyncio.Task[Any]] = set()
        self._thread = threading.Thread(target=self._loop.run_forever, name="outside", daemon=True)
        self._thread.start()

    def run(self, work: Coroutine[Any, Any, T]) -> T:
        """Run something short to its end, such as opening a port; raises what it raises."""
        return asyncio.run_coroutine_threadsafe(work, self._loop).result()

    def keep(self, work: Coroutine[Any, Any, object]) -> None:
        """Run something until the doors close; raises what it raises within its first step."""
        self.run(self._keep(work))

    def close(self) -> None:
        """Cancel what runs and end the thread."""
        if self._loop.is_closed():
            return
        self.run(self._cancel())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(_CLOSE_S)
        if not self._thread.is_alive():
            self._loop.close()

    async def _keep(self, work: Coroutine[Any, Any, object]) -> None:
        task = asyncio.ensure_future(work)
        self._tasks.add(task)
        await asyncio.sleep(0)
        if task.done():
            self._tasks.discard(task)
            task.result()

    async def _cancel(self) -> None:
        running = [task for task in asyncio.all_tasks() if task is not asyncio.current_task()]
        for task in running:
            task.cancel()
        if running:
            await asyncio.wait(running, timeout=_CLOSE_S)
