"""The fence of a served network: everything that enters passes here, is stamped, and is recorded."""

from collections.abc import Callable
from typing import Protocol

from bus.time import EventQueue


class Journal(Protocol):
    """Where entries are written; see `scenarios.doors.journal`."""

    def write(self, t_ns: int, kind: str, data: bytes) -> None:
        """Record one entry."""


class EntryError(RuntimeError):
    """Somebody tried to enter while simulated time was running: a bug in a door."""


class Entry:
    """Kinds of input by name and what each does. The same entries at the same times give the same trace.

    That holds because entries are made between slices only, when all events up to the present have happened.
    """

    def __init__(self, queue: EventQueue, journal: Journal | None = None) -> None:
        self.count = 0
        self._queue = queue
        self._journal = journal
        self._apply: dict[str, Callable[[bytes], None]] = {}
        self.running = False

    def register(self, kind: str, apply: Callable[[bytes], None]) -> None:
        """Let `kind` enter: `apply(data)` puts it into the network, at the present. One registration each."""
        if kind in self._apply:
            raise EntryError(f"{kind} is registered twice")
        self._apply[kind] = apply

    def enter(self, kind: str, data: bytes) -> None:
        """Something comes in, now."""
        if self.running:
            raise EntryError(f"{kind} would enter in the middle of a slice")
        if self._journal is not None:
            self._journal.write(self._queue.now_ns, kind, data)
        self.count += 1
        self._apply[kind](data)

    def kinds(self) -> list[str]:
        """What may enter, in the order it was registered."""
        return list(self._apply)
