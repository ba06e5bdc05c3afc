"""One link, one task: it opens its port, reads, and opens it again when it breaks. Others never notice."""

import threading
from collections.abc import Callable
from queue import SimpleQueue
from typing import Protocol

from host.logs.files import reason as reason_of

READ_S = 0.2
"""Longest wait within a read; how soon a task notices that it shall end."""
RETRY_S = 1.0


class Port(Protocol):
    """Something that is open."""

    def read(self) -> bytes:
        """What has come, after at most READ_S; empty when nothing has. Raises OSError when it breaks."""

    def write(self, data: bytes) -> None:
        """Send. Raises OSError when it breaks."""

    def close(self) -> None:
        """Let go of it."""


class LinkTask:
    """A thread that reads one port into `inbox` as (name, bytes).

    say: called with one line when the port opens or breaks; from the task, so it has to be thread-safe.
    lost: writes that found it broken.
    """

    def __init__(
        self,
        name: str,
        opener: Callable[[], Port],
        inbox: SimpleQueue[tuple[str, bytes]],
        say: Callable[[str], None],
    ) -> None:
        self.name = name
        self.lost = 0
        self.breaks = 0
        self._opener = opener
        self._inbox = inbox
        self._say = say
        self._port: Port | None = None
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    def start(self) -> None:
        """Begin; a port that is not there is tried again every second."""
        self._thread.start()

    @property
    def is_open(self) -> bool:
        """Whether the port is there."""
        return self._port is not None

    def write(self, data: bytes) -> None:
        """Send, or count it lost."""
        port = self._port
        try:
            if port is None:
                raise OSError("closed")
            port.write(data)
        except Exception:  # the reading side reports what broke
            self.lost += 1

    def close(self) -> None:
        """End the task."""
        self._end.set()
        if self._thread.is_alive():
            self._thread.join(2 * READ_S + RETRY_S)

    def _run(self) -> None:
        reason = ""
        while not self._end.is_set():
            try:
                self._port = self._opener()
                self._say(f"{self.name}: open")
                reason = ""
                while not self._end.is_set():
                    data = self._port.read()
                    if data:
                        self._inbox.put((self.name, data))
            except Exception as error:  # whatever a driver raises, it breaks this link only
                self.breaks += 1
                words = reason_of(error)
                if words != reason:
                    self._say(f"{self.name}: broken: {words}; tried again every second")
                    reason = words
            finally:
                port, self._port = self._port, None
                if port is not None:
                    port.close()
            self._end.wait(RETRY_S)
