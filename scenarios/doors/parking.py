"""The end of serving: the axes go to the park position, or at least to rest, and the motors off."""

from collections.abc import Callable, Iterable
from time import perf_counter

from bus.protocol import Device, MotionFlag, Opcode, SpeedClass, pack_command, unpack_motion, unpack_target
from bus.protocol.report import pack_report
from host.link import HidLink
from host.procedures.manual import AXES
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.lab.wiring import start_steps

_WALL_S = 0.5
"""Simulated time runs as fast as it can for this long; with all the rest it stays below a second."""
_STEP_NS = 50_000_000
_FRESH_NS = 1_000_000_000


class _Way:
    """A host program of its own on the cable, whose time runs as fast as it can. end_s: when it has to be
    there, wall time."""

    def __init__(self, served: LiveNetwork) -> None:
        self._served = served
        self.plug = served.usb.plug("parking")
        self.link = HidLink(self.plug.write)
        self.end_s = perf_counter() + _WALL_S

    def go(self, done: Callable[[], bool], until_s: float) -> bool:
        """On until `done`; False when wall time is over before."""
        while not done():
            if perf_counter() > until_s:
                return False
            self._served.run_until(self._served.now_ns + _STEP_NS)
            for t_ns, report in self.plug.reports():
                self.link.receive(t_ns, report)
        return True

    def send(self, *commands: bytes) -> None:
        """In one report."""
        self.plug.write(self._served.now_ns, pack_report(commands))

    def axes_with(self, flag: int) -> list[Device]:
        """Axes whose last MOTION frame has a flag."""
        heard = ((device, self.link.measurements.get(device)) for device in AXES.values())
        return [device for device, data in heard if data is not None and unpack_motion(data).flags & flag]

    def settled(self, devices: Iterable[Device]) -> bool:
        """Whether all have told that they are there."""
        told = [self.link.summaries.get(device) for device in devices]
        return all(data is not None and unpack_target(data).settled for data in told)


def park(served: LiveNetwork) -> str:
    """Send both axes to the park position, unpaced, and take the power off; says how far that came.

    The doors are closed by now. The commands go through the gateway and are recorded like anybody's.
    """
    served.entry.running = False
    served.punctual.counting = False
    way = _Way(served)
    try:
        return _parked(served, way)
    finally:
        way.plug.unplug()


def _parked(served: LiveNetwork, way: _Way) -> str:
    heard_ns = served.now_ns + _FRESH_NS
    both = set(AXES.values())
    way.go(lambda: both <= set(way.link.measurements) or served.now_ns > heard_ns, way.end_s)
    powered, goals = way.axes_with(MotionFlag.POWERED), start_steps(served.scenario)
    if not powered:
        return "the motors were off"
    way.link.summaries.clear()
    way.send(
        *(
            pack_command(device, Opcode.MOVE_TO, round(goals[name]), SpeedClass.SLEW)
            for name, device in AXES.items()
            if device in powered
        )
    )
    fresh_ns = served.now_ns + _FRESH_NS
    parked = way.go(lambda: served.now_ns >= fresh_ns and way.settled(powered), way.end_s - 0.1)
    if not parked:
        way.send(*(pack_command(device, Opcode.STOP) for device in powered))
        way.go(lambda: not way.axes_with(MotionFlag.MOVING), way.end_s)
    way.send(*(pack_command(device, Opcode.POWER, 0) for device in powered))
    off_ns = served.now_ns + 4 * _STEP_NS
    way.go(lambda: served.now_ns >= off_ns, way.end_s + 0.1)
    return "parked, motors off" if parked else "stopped on the way to park (no time), motors off"
