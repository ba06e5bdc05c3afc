"""Who rules a network: the PC behind the gateway, which starts it, and masters whose heartbeats are seen."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from boards.silicon.hid import HidEndpoint
from bus.time.oscillator import Oscillator
from bus.time.queue import EventQueue

START: Final = 0x01
ALL: Final = 0x00
"""NMT: start, all nodes (CiA 301, 7.2.8.3.1)."""
_MS: Final = 1_000_000


class Host:
    """The PC at the gateway's cable, NMT master by its first report: it starts all nodes, then who boots up.

    command: sends an NMT command, `(specifier, node)`.
    """

    def __init__(self, hid: HidEndpoint, command: Callable[[int, int], None]) -> None:
        self.there = False
        self._take = hid.from_host
        self._command = command
        hid.from_host = self._report

    def _report(self, t_ns: int, report: bytes) -> None:
        if not self.there:
            self.there = True
            self._command(START, ALL)
        self._take(t_ns, report)

    def booted(self, node: int) -> None:
        """A node has said that it is up."""
        if self.there:
            self._command(START, node)


class Watched:
    """Heartbeats of 0x1016: a master that falls silent for longer than it may is lost, until it is back.

    changed: told the node number and whether it is there, at every change after the first heartbeat.
    """

    def __init__(
        self, queue: EventQueue, oscillator: Oscillator, changed: Callable[[int, bool], None]
    ) -> None:
        self._queue, self._oscillator, self._changed = queue, oscillator, changed
        self._periods: dict[int, int] = {}
        self._due: dict[int, int] = {}
        self.lost: set[int] = set()

    def set(self, entries: list[int]) -> None:
        """Watch these from their next heartbeat on: node number << 16 | ms; nothing where either is zero."""
        watched = {entry >> 16 & 0x7F: (entry & 0xFFFF) * _MS for entry in entries}
        self._periods = {node: period for node, period in watched.items() if node and period}
        self._due.clear()
        self.lost.clear()

    def heard(self, node: int, t_ns: int) -> None:
        """A heartbeat."""
        period = self._periods.get(node)
        if period is None:
            return
        if node in self.lost:
            self.lost.discard(node)
            self._changed(node, True)
        self._due[node] = self._oscillator.true_ns(self._oscillator.local_ns(t_ns) + period)
        self._queue.at(self._due[node], self._look)

    def _look(self, t_ns: int) -> None:
        for node in [node for node, due_ns in self._due.items() if due_ns <= t_ns]:
            del self._due[node]
            self.lost.add(node)
            self._changed(node, False)
