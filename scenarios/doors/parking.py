"""The end of serving: the axes go to the park position, or at least to rest, and the motors off."""

from collections.abc import Callable
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


def park(served: LiveNetwork) -> str:
    """Send both axes to the park position, unpaced, and take the power off; says how far that came.

    The doors are closed by now. The commands go through the gateway and are recorded like anybody's.
    """
    served.entry.running = False
    served.punctual.counting = False
    plug = served.usb.plug("parking")
    link = HidLink(plug.write)
    end_s = perf_counter() + _WALL_S

    def go(done: Callable[[], bool], until_s: float) -> bool:
        while not done():
            if perf_counter() > until_s:
                return False
            served.run_until(served.now_ns + _STEP_NS)
            for t_ns, report in plug.reports():
                link.receive(t_ns, report)
        return True

    def send(*commands: bytes) -> None:
        plug.write(served.now_ns, pack_report(commands))

    def axes_with(flag: int) -> list[Device]:
        found = []
        for device in AXES.values():
            data = link.measurements.get(device)
            if data is not None and unpack_motion(data).flags & flag:
                found.append(device)
        return found

    heard_ns = served.now_ns + _FRESH_NS
    go(lambda: len(set(AXES.values()) & set(link.measurements)) == 2 or served.now_ns > heard_ns, end_s)
    powered = axes_with(MotionFlag.POWERED)
    if not powered:
        plug.unplug()
        return "the motors were off"
    targets = start_steps(served.scenario)
    link.summaries.clear()
    send(
        *(
            pack_command(device, Opcode.MOVE_TO, round(targets[name]), SpeedClass.SLEW)
            for name, device in AXES.items()
            if device in powered
        )
    )
    sent_ns = served.now_ns

    def settled() -> bool:
        if served.now_ns - sent_ns < _FRESH_NS:
            return False
        data = [link.summaries.get(device) for device in powered]
        return all(each is not None and unpack_target(each).settled for each in data)

    parked = go(settled, end_s - 0.1)
    if not parked:
        send(*(pack_command(device, Opcode.STOP) for device in powered))
        go(lambda: not axes_with(MotionFlag.MOVING), end_s)
    send(*(pack_command(device, Opcode.POWER, 0) for device in powered))
    off_ns = served.now_ns + _STEP_NS * 4
    go(lambda: served.now_ns >= off_ns, end_s + 0.1)
    plug.unplug()
    return "parked, motors off" if parked else "stopped on the way to park (no time), motors off"
