"""Keeps a door open: polls it, and when it breaks reports it and tries again while the others go on."""

from collections.abc import Callable
from time import monotonic

import can

from scenarios.doors.door import Door

RETRY_S = 1.0
"""Wall time between two attempts to open a broken door."""


class Keeper:
    """One door and whether it is open. report: called with one line when that changes."""

    def __init__(self, door: Door, report: Callable[[str], None]) -> None:
        self.door = door
        self.is_open = False
        self.breaks = 0
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
        self.is_open = False
        self.breaks += 1
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
