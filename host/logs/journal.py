"""What the host has to say, kept for whoever looks and passed on to the ASCII logs (H2, H6)."""

from collections import deque
from collections.abc import Callable
from typing import NamedTuple

KEPT = 1000
"""Entries kept for status windows; the files keep all. ASSUMPTION: an hour of a quiet night."""


class Logs:
    """Where commands, status, readings and errors go; whoever keeps them writes `_keep`."""

    def command(self, t_ns: int, node: str, text: str, result: str) -> None:
        """A command of the user and what came of it."""
        self._keep("command", t_ns, node, text, result)

    def status(self, t_ns: int, device: str, text: str) -> None:
        """What a device says about itself, or what the programme is doing."""
        self._keep("status", t_ns, device, text)

    def sensors(self, t_ns: int, text: str) -> None:
        """A line of readings."""
        self._keep("sensors", t_ns, text)

    def error(self, t_ns: int, where: str, text: str) -> None:
        """Something that went wrong."""
        self._keep("error", t_ns, where, text)

    def _keep(self, kind: str, t_ns: int, *words: str) -> None:
        raise NotImplementedError


class Entry(NamedTuple):
    """One event; kind is `command`, `status` or `error`; number counts from 1 without a gap."""

    number: int
    t_s: float
    kind: str
    where: str
    text: str


class Journal(Logs):
    """Keeps the last entries but readings; hands all on, to files and to listeners on the ticking thread."""

    def __init__(self, files: Logs | None = None) -> None:
        self.entries: deque[Entry] = deque(maxlen=KEPT)
        self.listeners: list[Callable[[Entry], None]] = []
        self.errors = 0
        self._number = 0
        self._files = files

    def since(self, number: int) -> list[Entry]:
        """Entries after `number` that are still kept; safe from any thread."""
        return [entry for entry in self.entries.copy() if entry.number > number]

    def _keep(self, kind: str, t_ns: int, *words: str) -> None:
        if self._files is not None:
            self._files._keep(kind, t_ns, *words)
        if kind == "sensors":
            return
        self.errors += kind == "error"
        self._number += 1
        entry = Entry(self._number, t_ns * 1e-9, kind, words[0], ": ".join(words[1:]))
        self.entries.append(entry)
        for listener in self.listeners:
            listener(entry)
