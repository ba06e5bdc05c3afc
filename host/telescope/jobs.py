"""Procedures with a handle: what runs, how it ended, and who may wait for it from another thread.

Why the telescope does not do something has a form that each door can translate into its own numbers.
"""

from collections.abc import Generator
from concurrent.futures import Future
from contextlib import suppress
from enum import Enum
from typing import Generic, TypeVar

from host.client import ClientError, CommandRefused


class Reason(Enum):
    """What stands in the way."""

    BELOW_HORIZON = "below the horizon limit"
    LIMIT = "beyond a soft limit"
    PARKED = "parked"
    STATE = "not possible in this state"
    SLAVED = "the dome follows the telescope"
    VALUE = "out of range"
    LOCKED = "the console is locked"
    SILENT = "no answer"
    CANCELLED = "cancelled"


class Refused(ValueError):
    """A command that was not carried out; `reason` for programs, the text for people."""

    def __init__(self, reason: Reason, text: str) -> None:
        super().__init__(text)
        self.reason = reason


T = TypeVar("T")


class Activity(Enum):
    """What the axes are busy with."""

    IDLE = "idle"
    POWERING = "powering up"
    SLEWING = "slewing"
    TRACKING = "tracking"
    PADDLE = "moved by hand"
    STOPPING = "stopping"
    PARKING = "parking"


class Job(Generic[T]):
    """A procedure under way. `finished` holds its value, or `Refused` when it failed or was cancelled."""

    def __init__(self, name: str, procedure: Generator[None, None, T], activity: Activity) -> None:
        self.name = name
        self.activity = activity
        self.finished: Future[T] = Future()
        self._procedure = procedure

    @property
    def running(self) -> bool:
        """Whether it has not ended yet."""
        return not self.finished.done()

    def advance(self) -> None:
        """Go on until the procedure waits again; called on the ticking thread only."""
        if not self.running:
            return
        try:
            next(self._procedure)
        except StopIteration as end:
            self.finished.set_result(end.value)
        except Refused as refusal:
            self.finished.set_exception(refusal)
        except CommandRefused as error:
            self.finished.set_exception(Refused(Reason.STATE, str(error)))
        except ClientError as error:
            self.finished.set_exception(Refused(Reason.SILENT, str(error)))

    def cancel(self, why: str) -> None:
        """End it where it stands."""
        if self.running:
            self._procedure.close()
            self.finished.set_exception(Refused(Reason.CANCELLED, f"{self.name}: {why}"))

    @property
    def failed(self) -> str:
        """Why it failed; empty while it runs, when it went well or was cancelled."""
        error = self.finished.exception() if self.finished.done() else None
        cancelled = isinstance(error, Refused) and error.reason is Reason.CANCELLED
        return "" if error is None or cancelled else str(error)


class Side:
    """Short procedures that run beside each other and beside whatever the axes do."""

    def __init__(self) -> None:
        self._jobs: list[Job[object]] = []

    def start(self, job: Job[T]) -> Job[T]:
        """Start one; it makes its first step at once."""
        job.advance()
        if job.running:
            self._jobs.append(job)  # type: ignore[arg-type]
        return job

    def tick(self) -> None:
        """Advance all and forget what has ended."""
        for job in self._jobs:
            with suppress(Refused):
                job.advance()
        self._jobs = [job for job in self._jobs if job.running]
