"""What every door of a served network is, and its keeper: a door that breaks is reported and opened again."""

from collections.abc import Callable
from time import monotonic
from typing import Protocol

import can


def counted(*told: tuple[int, str]) -> str:
    """Counts in words, `3 clients, 2 refused`, without what there was none of."""
    return ", ".join(f"{count} {what}" for count, what in told if count)


class Door(Protocol):
    """A way in from outside. `schmidt serve` holds any number and knows nothing else of them.

    Everything is called from one thread, between two slices of simulated time. What enters goes through
    `Entry` (or a `UsbPlug`, which does so), never straight into the network: there it is stamped and
    recorded.
    """

    name: str
    """As the user wrote it, for reports: `--can socketcan:vcan0`."""

    def open(self) -> None:
        """Bind, attach, connect. Raises OSError, ValueError or can.CanError with the reason it cannot."""

    def poll(self, now_ns: int) -> None:
        """Take what has arrived, hand out what has happened until `now_ns` (simulated). Never blocks.

        Raises OSError or can.CanError when the door is broken: it is closed, reported, and opened again
        later. A client that misbehaves is the door's own business.
        """

    def close(self) -> None:
        """Let go of everything; twice does nothing, and so does closing what never opened."""

    def state(self) -> str:
        """Words for the end: clients, counts, what was refused. Empty: nobody was there."""


RETRY_S = 1.0
"""Wall time between two attempts to open a broken door."""


class Keeper:
    """One door and whether it is open. report: called with one line when that changes; other doors go on."""

    def __init__(self, door: Door, report: Callable[[str], None]) -> None:
        self.door = door
        self.is_open = False
        self.bugs = 0
        """Errors no door declares; each is one of ours, reported as such."""
        self._report = report
        self._next_s = 0.0
        self._reason = ""

    def open(self) -> None:
        """Open for the first time; an error is the user's and goes through."""
        self.door.open()
        self.is_open = True

    def poll(self, now_ns: int) -> None:
        """One look, or one attempt to open again."""
        if not self.is_open:
            if monotonic() >= self._next_s:
                self._again()
            return
        try:
            self.door.poll(now_ns)
        except (OSError, ValueError, can.CanError) as error:
            self._broken(_words(error))
        except Exception as error:  # one door must not end the telescope, whatever is wrong with it
            self.bugs += 1
            self._broken(f"internal error, please report it: {type(error).__name__}: {_words(error)}")

    def _again(self) -> None:
        try:
            self.door.open()
        except Exception as error:
            self.door.close()
            self._next_s = monotonic() + RETRY_S
            reason = _words(error)
            if reason != self._reason:
                self._reason = reason
                self._report(f"{self.door.name}: still closed: {reason}")
            return
        self.is_open = True
        self._reason = ""
        self._report(f"{self.door.name}: open again")

    def _broken(self, reason: str) -> None:
        self._reason = reason
        self._next_s = monotonic() + RETRY_S
        self._report(f"{self.door.name}: broken: {reason}; the others go on, it is tried again every second")
        self.close()

    def close(self) -> None:
        """Close the door, whatever it thinks of that."""
        self.is_open = False
        try:
            self.door.close()
        except (OSError, ValueError, can.CanError) as error:
            self._report(f"{self.door.name}: closing: {_words(error)}")


def _words(error: BaseException) -> str:
    return " ".join(str(error).split()) or type(error).__name__
