"""The end of serving: by a signal, between two slices; both axes are parked, or it is said which is not."""

import signal
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress

from bus.protocol import Device, MotionFlag, Opcode, SpeedClass, unpack_target
from host.client import TICK_NS, Client, ClientError, Procedure
from host.link import HidLink
from host.logs.journal import Journal
from host.procedures.manual import AXES, powered
from host.procedures.pointing import REACH
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.usb import UsbFull


@contextmanager
def interrupts(stop: Callable[[], None]) -> Iterator[None]:
    """Within, the first Ctrl-C or SIGTERM calls `stop`; a second one raises KeyboardInterrupt at once.

    Outside the main thread nobody gets signals, so nothing is changed there.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    asked = False

    def handle(_signal: int, _frame: object) -> None:
        nonlocal asked
        if asked:
            raise KeyboardInterrupt
        asked = True
        stop()

    before = {number: signal.signal(number, handle) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


BEGUN = "parking the axes; Ctrl-C again stops them where they are"
_HEARD_S = 1.0  # A hundred MOTION frames, four of TARGET: an axis that has sent none is not there.
_REST_S = 5.0  # From 2°/s an axis stops within a second or two. ASSUMPTION: thrice that.


class _Way:
    """A host program of its own on the cable, whose time runs as fast as it can."""

    def __init__(self, served: LiveNetwork) -> None:
        self._served = served
        self.plug = served.usb.plug("parking")
        self.link = HidLink(self._send)
        self.client = Client(self.link, Journal(), tuple(AXES.values()))
        self.interrupted = False

    def interrupt(self) -> None:
        """Give up what is under way."""
        self.interrupted = True

    def go(self, axes: Iterable[Device], what: Callable[[Device], Procedure]) -> dict[Device, str]:
        """All axes side by side to the end of their procedures; what came between, by axis."""
        running, failed = {axis: what(axis) for axis in axes}, dict[Device, str]()
        while running and not self.interrupted:
            self._served.run_until(self._served.now_ns + TICK_NS)
            for t_ns, report in self.plug.reports():
                self.link.receive(t_ns, report)
            self.client.tick(self._served.now_ns)
            for axis, procedure in list(running.items()):
                try:
                    next(procedure)
                    continue
                except StopIteration:
                    pass
                except ClientError as error:
                    failed[axis] = str(error)
                del running[axis]
        for axis in running:
            self.client.forget(axis)
            failed[axis] = "interrupted"
        self.interrupted = False
        return failed

    def heard(self, axis: Device) -> Procedure:
        """Until the axis has said anything at all; CANopen's nodes do after the host's first report."""
        try:
            yield from self.client.until("no frame", lambda: axis in self.link.measurements, _HEARD_S)
        except ClientError:
            with suppress(ClientError):
                yield from self.client.ask(axis, Opcode.PING)
            yield from self.client.until("no frame", lambda: axis in self.link.measurements, _HEARD_S)

    def move(self, axis: Device, goal: int) -> Procedure:
        """To a place, steps, and at rest there."""
        yield from self.client.ask(axis, Opcode.TRACK_RATE, 0)
        yield from self.client.ask(axis, Opcode.MOVE_TO, goal, SpeedClass.SLEW)
        yield from self.client.wait(_HEARD_S)  # what it tells of its target is of this one from now on
        yield from self.client.until("on its way", lambda: self._settled(axis), REACH["slew"].timeout_s)

    def halt(self, axis: Device) -> Procedure:
        """Stop it where it is."""
        yield from self.client.ask(axis, Opcode.STOP)
        yield from self.client.until("does not rest", lambda: self._rests(axis), _REST_S)

    def off(self, axis: Device) -> Procedure:
        """Its motors, and wait until it says so."""
        yield from self.client.ask(axis, Opcode.POWER, 0)
        yield from self.client.until("stays on", lambda: not powered(self.client, axis), _HEARD_S)

    def _send(self, t_ns: int, report: bytes) -> None:
        with suppress(UsbFull):  # as if it were lost on the way: the client asks again
            self.plug.write(t_ns, report)

    def _settled(self, axis: Device) -> bool:
        data = self.link.summaries.get(axis)
        return data is not None and bool(unpack_target(data).settled)

    def _rests(self, axis: Device) -> bool:
        motion = self.client.motion(axis)
        return motion is not None and not motion.flags & MotionFlag.MOVING


def park(served: LiveNetwork, say: Callable[[str], None] = print) -> str:
    """Send both axes to the park position, unpaced, and take the power off; says how far that came.

    The doors are closed by now. The commands go through the gateway and are recorded like anybody's. say:
    told when axes have to move. A signal ends the move, whatever is left of it.
    """
    served.entry.running = False
    served.punctual.counting = False
    way = _Way(served)
    try:
        with interrupts(way.interrupt):
            return _parked(served, way, say)
    finally:
        way.plug.unplug()


def _parked(served: LiveNetwork, way: _Way, say: Callable[[str], None]) -> str:
    goals = dict(zip(AXES.values(), served.scenario.mount.park_steps, strict=True))
    there = [axis for axis in goals if axis.name in served.network.boards]
    failed = way.go(there, way.heard)
    silent = {axis: why for axis, why in failed.items() if axis not in way.link.measurements}
    moving = [axis for axis in there if axis not in silent and powered(way.client, axis)]
    if not moving and not silent:
        return "the motors were off"
    if moving:
        say(BEGUN)
    failed = way.go(moving, lambda axis: way.move(axis, goals[axis]))
    moved = way.go(failed, way.halt)
    on = way.go(moving, way.off)
    words = [f"{axis.name} is silent, its motors are as they were ({why})" for axis, why in silent.items()]
    words += [f"{axis.name} is not parked ({why})" for axis, why in failed.items()]
    words += [f"{axis.name} did not come to rest ({why})" for axis, why in moved.items() if axis not in on]
    words += [f"the motors of {axis.name} may be on ({why})" for axis, why in on.items()]
    if not words:
        return "parked, motors off"
    parked = [axis.name for axis in moving if axis not in failed]
    are = "are" if len(parked) > 1 else "is"
    return "; ".join(words + [f"{' and '.join(parked)} {are} parked"] * bool(parked))
