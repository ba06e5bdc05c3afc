"""Real-time scheduling for the ticks and the doors' threads beside them (`serve`, unless `--no-realtime`).

A door's thread may hold Python's lock while an ordinary program has its processor. That would hold up a tick,
so all threads of the process are lifted. The process' children, and threads that come later, are ordinary.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from scenarios.doors.door import DoorError

AHEAD = "ticks run before other programs, as the system allows it"
NOT_GRANTED = "run as root, or give the user an rtprio limit (ulimit -r 1)"
_PRIORITY = 1
"""The lowest of the real-time class: before all ordinary programs, after what the system's own owner put
higher."""
_THREADS = Path("/proc/self/task")


@contextmanager
def first(asked: bool = True) -> Iterator[str]:
    """This process before all ordinary programs; the line that says so.

    Where the system has no such class or does not grant it, this raises DoorError. If nobody asked for it,
    the line says what to do.
    """
    said = AHEAD
    before: dict[int, int] = {}
    try:
        for thread in _threads():
            with suppress(ProcessLookupError):  # it has ended
                policy = os.sched_getscheduler(thread)
                os.sched_setscheduler(thread, os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(_PRIORITY))
                before[thread] = policy & ~os.SCHED_RESET_ON_FORK
    except AttributeError:
        if asked:
            raise DoorError("--realtime: this system has no real-time scheduling for programs") from None
        said = "ticks run among other programs; busy ones make them late, so end those"
    except OSError:
        _back(before)
        if asked:
            raise DoorError(f"--realtime: not granted; {NOT_GRANTED}") from None
        said = f"ticks run among other programs; if busy ones make them late, {NOT_GRANTED}"
    try:
        yield said
    finally:
        _back(before)


def _threads() -> list[int]:
    """Identifiers of this process's threads; 0 is the calling one's, where the system does not list them."""
    return [int(each.name) for each in _THREADS.iterdir()] if _THREADS.is_dir() else [0]


def _back(before: dict[int, int]) -> None:
    for thread, policy in before.items():
        with suppress(OSError):
            os.sched_setscheduler(thread, policy, os.sched_param(0))
