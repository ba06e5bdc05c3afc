"""Real-time scheduling for the ticks and the doors' threads beside them (`serve --realtime`).

A door's thread may hold Python's lock while an ordinary program has its processor. That would hold up a tick,
so all threads of the process are lifted. The process' children, and threads that come later, are ordinary.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from scenarios.doors.door import DoorError

_PRIORITY = 1
"""The lowest of the real-time class: before all ordinary programs, after what the system's own owner put
higher."""
_THREADS = Path("/proc/self/task")


@contextmanager
def first() -> Iterator[None]:
    """This process before all ordinary programs. Raises DoorError where the system has no such class or does
    not grant it."""
    before: dict[int, int] = {}
    try:
        for thread in _threads():
            with suppress(ProcessLookupError):  # it has ended
                policy = os.sched_getscheduler(thread)
                os.sched_setscheduler(thread, os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(_PRIORITY))
                before[thread] = policy & ~os.SCHED_RESET_ON_FORK
    except AttributeError:
        raise DoorError("--realtime: this system has no real-time scheduling for programs") from None
    except OSError:
        _back(before)
        raise DoorError(
            "--realtime: not granted; run as root, or give the user an rtprio limit (ulimit -r 1)"
        ) from None
    try:
        yield
    finally:
        _back(before)


def _threads() -> list[int]:
    """Identifiers of this process's threads; 0 is the calling one's, where the system does not list them."""
    return [int(each.name) for each in _THREADS.iterdir()] if _THREADS.is_dir() else [0]


def _back(before: dict[int, int]) -> None:
    for thread, policy in before.items():
        with suppress(OSError):
            os.sched_setscheduler(thread, policy, os.sched_param(0))
