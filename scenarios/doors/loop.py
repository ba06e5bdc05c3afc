"""The loop of `schmidt serve`: doors are polled between two slices, and once a second things are said.

A door's thread may hold Python's lock while an ordinary program has its processor. That would hold up a tick,
so all threads of the process may be lifted (`first`, unless `--no-realtime`). The process' children, and
threads that come later, are ordinary.
"""

import gc
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

from rich.console import Console

from scenarios.doors.control import ControlDoor
from scenarios.doors.door import Keeper, counted
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.recording import Recording

AHEAD = "ticks run before other programs, as the system allows it"
NOT_GRANTED = "run as root, or give the user an rtprio limit (ulimit -r 1)"
_PRIORITY = 1
"""The lowest of the real-time class: before ordinary programs, after what the system's owner put higher."""
_THREADS = Path("/proc/self/task")


@contextmanager
def first(asked: bool = True) -> Iterator[str]:
    """This process before all ordinary programs; the line that says so.

    Where the system has no such class or does not grant it, this raises OSError. If nobody asked for it,
    the line says what to do.
    """
    said = AHEAD
    before: dict[int, int] = {}
    try:
        for thread in [int(each.name) for each in _THREADS.iterdir()] if _THREADS.is_dir() else [0]:
            with suppress(ProcessLookupError):  # it has ended
                policy = os.sched_getscheduler(thread)
                os.sched_setscheduler(thread, os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(_PRIORITY))
                before[thread] = policy & ~os.SCHED_RESET_ON_FORK
    except AttributeError:
        if asked:
            raise OSError("--realtime: this system has no real-time scheduling for programs") from None
        said = "ticks run among other programs; busy ones make them late, so end those"
    except OSError:
        _back(before)
        if asked:
            raise OSError(f"--realtime: not granted; {NOT_GRANTED}") from None
        said = f"ticks run among other programs; if busy ones make them late, {NOT_GRANTED}"
    try:
        yield said
    finally:
        _back(before)


def _back(before: dict[int, int]) -> None:
    for thread, policy in before.items():
        with suppress(OSError):
            os.sched_setscheduler(thread, policy, os.sched_param(0))


_STATUS_S = 1.0  # Wall time between two status lines. ASSUMPTION.


@dataclass
class Loop:
    """Looks at the doors before every slice, says once a second how things stand. show: takes that line."""

    served: LiveNetwork
    keepers: Sequence[Keeper]
    console: Console
    show: Callable[[str], None]
    duration_s: float | None
    recording: Recording | None
    _end_ns: int | None = None
    _slow: bool = False

    def run(self) -> None:
        """Until somebody ends it."""
        gc.collect()
        gc.freeze()  # a collection that walks the whole network makes a tick late
        served = self.served
        stepped = served.steps is not None
        self._planes = [each for each in self.keepers if stepped and isinstance(each.door, ControlDoor)]
        self._keepers = [each for each in self.keepers if each not in self._planes]
        now_s = perf_counter()
        self._next_s = now_s + _STATUS_S
        self._flush_s = self._next_s + _STATUS_S / 2
        self._second = (now_s, served.now_ns, 0)
        self._end_s = None if self.duration_s is None else now_s + self.duration_s
        try:
            if served.steps is None:
                served.pacer.run(each_slice=self._slice)
            else:
                served.steps.run(self._slice, self._wait)
        finally:
            served.entry.running = False
            served.punctual.counting = False
            self._end_ns = served.now_ns  # parking comes after it
            gc.unfreeze()

    def _slice(self) -> bool:
        """Between two slices; True when it is over."""
        served = self.served
        served.entry.running = False
        now_ns = served.now_ns
        for keeper in self._keepers:
            keeper.poll(now_ns)
        now_s = perf_counter()
        if now_s >= self._next_s:
            self._next_s = now_s + _STATUS_S
            pace = self._keeping_up(now_s)
            self.show(f"{self.text()}, {'paused' if served.pacer.paused else f'{pace:.2f} times real time'}")
        elif now_s >= self._flush_s and self.recording is not None:  # another slice: half a millisecond each
            self._flush_s = now_s + _STATUS_S
            self.recording.flush()
        served.entry.running = True
        return self._over(now_s)

    def _wait(self, timeout_s: float) -> bool:
        """Time stands until a client says something at the control plane; True when it is over."""
        for keeper in self._planes:
            if isinstance(keeper.door, ControlDoor):
                keeper.door.wait(timeout_s)
            keeper.poll(self.served.now_ns)
        return self._over(perf_counter())

    def _over(self, now_s: float) -> bool:
        return self.served.ending or (self._end_s is not None and now_s >= self._end_s)

    def _keeping_up(self, now_s: float) -> float:
        """The pace of the last second; said when the machine is too slow, and when it no longer is."""
        served = self.served
        before_s, before_ns, slips = self._second
        self._second = (now_s, served.now_ns, served.pacer.slips)
        pace = (served.now_ns - before_ns) * 1e-9 / max(now_s - before_s, 1e-9)
        slow = served.pacer.slips > slips
        if slow and not self._slow:
            wanted = served.pacer.speed
            self.console.print(
                f"this machine cannot keep up: {pace:.2f} of {wanted:g} times real time. Time runs slower. "
                "Boards lose no frame. What clients send too fast is refused and counted."
            )
        elif self._slow and not slow:
            self.console.print(f"keeping up again at {pace:.2f} times real time")
        self._slow = slow
        return pace

    def text(self) -> str:
        """One line of how things stand, or stood when the loop ended. Time given up is what the wall had of
        it and the boards did not; in steps, or paused, nobody wants any."""
        served = self.served
        words = [f"{(self._end_ns or served.now_ns) * 1e-9:.1f} s simulated"]
        if served.pacer.slips:
            words.append(f"{served.pacer.slipped_s:.1f} s given up on a machine too slow")
        words.append(f"bus load {served.network.wire.load:.1%}")
        return ", ".join([*words, counted((served.entry.count, "inputs")) or "no input"])
