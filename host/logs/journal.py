"""What the host has to say, kept for whoever looks and passed on to the ASCII logs (H2, H6)."""

from collections import deque
from collections.abc import Callable
from typing import NamedTuple, Protocol

KEPT = 1000
"""Entries kept for status windows; the files keep all. ASSUMPTION: an hour of a quiet night."""


class Logs(Protocol):
    """Where commands, status, readings and errors go."""

    def command(self, t_ns: int, node: str, text: str, result: str) -> None:
        """A command of the user and what came of it."""

    def status(self, t_ns: int, device: str, text: str) -> None:
        """What a device says about itself."""

    def sensors(self, t_ns: int, text: str) -> None:
        """A line of readings."""

    def error(self, t_ns: int, where: str, text: str) -> None:
        """Something that went wrong."""


class Entry(NamedTuple):
    """One event; kind is `command`, `status` or `error`; number counts from 1 without a gap."""

    number: int
    t_s: float
    kind: str
    where: str
    text: str


class Journal:
    """Keeps the last entries and hands every one on: to files, and to listeners on the ticking thread."""

    def __init__(self, files: Logs | None = None) -> None:
        self.entries: deque[Entry] = deque(maxlen=KEPT)
        self.listeners: list[Callable[[Entry], None]] = []
        self.errors = 0
        self._number = 0
        self._files = files

    def command(self, t_ns: int, node: str, text: str, result: str) -> None:
        """A command of the user and what came of it."""
        if self._files is not None:
            self._files.command(t_ns, node, text, result)
        self._keep(t_ns, "command", node, f"{text}: {result}")

    def status(self, t_ns: int, device: str, text: str) -> None:
        """What a device says about itself."""
        if self._files is not None:
            self._files.status(t_ns, device, text)
        self._keep(t_ns, "status", device, text)

    def sensors(self, t_ns: int, text: str) -> None:
        """A line of readings: to the files only."""
        if self._files is not None:
            self._files.sensors(t_ns, text)

    def error(self, t_ns: int, where: str, text: str) -> None:
        """Something that went wrong."""
        self.errors += 1
        if self._files is not None:
            self._files.error(t_ns, where, text)
        self._keep(t_ns, "error", where, text)

    def since(self, number: int) -> list[Entry]:
        """Entries after `number` that are still kept; safe from any thread."""
        return [entry for entry in self.entries.copy() if entry.number > number]

    def _keep(self, t_ns: int, kind: str, where: str, text: str) -> None:
        self._number += 1
        entry = Entry(self._number, t_ns * 1e-9, kind, where, text)
        self.entries.append(entry)
        for listener in self.listeners:
            listener(entry)
