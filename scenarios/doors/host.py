"""A host program within the emulator's own process: a telescope client on the gateway's USB.

`schmidt serve` has its host in a process beside it (`hostprocess`); this one is for who owns the time, as
tests do."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

from host.outside import Outside
from scenarios.doors.served import Served
from scenarios.doors.usb import UsbPlug
from scenarios.hosted import Hosted


class Host(Protocol):
    """What doors for other programs need: `HostDoor`, or the host program by itself."""

    @property
    def hosted(self) -> Hosted:
        """The telescope client."""

    @property
    def outside(self) -> Outside:
        """Where servers run."""


class HostDoor:
    """Opened first, closed last of those that use it. outside: the thread their servers live in.

    It commands through a `UsbPlug` like any host program, so a recorded session replays without it.
    """

    def __init__(self, served: Served, logs: Path | None = None) -> None:
        self.name = "the host"
        self.hosted = Hosted(served.scenario, self._send, list(served.network.boards), logs)
        self._served = served
        self._plug: UsbPlug | None = None
        self._outside: Outside | None = None

    @property
    def outside(self) -> Outside:
        """Where servers run; started when the first needs it."""
        if self._outside is None:
            self._outside = Outside()
        return self._outside

    def open(self) -> None:
        """Plug in."""
        self._plug = self._served.usb.plug(self.name)

    def poll(self, now_ns: int) -> None:
        """What the gateway has sent, then a tick when one is due."""
        if self._plug is not None:
            for t_ns, report in self._plug.reports():
                self.hosted.link.receive(t_ns, report)
            self.hosted.poll(now_ns)

    def close(self) -> None:
        """Unplug. The telescope is told once and for all when serving ends."""
        if self._outside is not None:
            self._outside.close()
            self._outside = None
        if self._plug is not None:
            self._plug.unplug()
            self._plug = None
            self.hosted.close()

    def state(self) -> str:
        """What the telescope does."""
        now = self.hosted.telescope.snapshot
        return f"{now.activity}, {self.hosted.journal.errors} errors"

    def _send(self, t_ns: int, report: bytes) -> None:
        if self._plug is not None:
            self._plug.write(t_ns, report)
