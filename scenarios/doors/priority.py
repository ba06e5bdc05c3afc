"""Real-time scheduling for the ticks (`serve --realtime`)."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from scenarios.doors.door import DoorError

_PRIORITY = 1
"""The lowest of the real-time class: before all ordinary programs, after what the system's own owner put
higher."""


@contextmanager
def first() -> Iterator[None]:
    """This thread before all ordinary programs; its children are ordinary again. Raises DoorError where the
    system has no such class or does not grant it."""
    try:
        before = os.sched_getscheduler(0)
        os.sched_setscheduler(0, os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(_PRIORITY))
    except AttributeError:
        raise DoorError("--realtime: this system has no real-time scheduling for programs") from None
    except OSError:
        raise DoorError(
            "--realtime: not granted; run as root, or give the user an rtprio limit (ulimit -r 1)"
        ) from None
    try:
        yield
    finally:
        os.sched_setscheduler(0, before & ~os.SCHED_RESET_ON_FORK, os.sched_param(0))
