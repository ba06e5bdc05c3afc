"""Buttons of the main console: speed classes, rates, open loop, stop, parameters (H2, B2)."""

from collections.abc import Iterable

from bus.protocol import Device, Opcode, SpeedClass
from bus.protocol.scales import rate_q16
from host.client import Client, ClientError, Procedure
from host.rates import EFFORT_FULL

AXES = {"ra": Device.AXIS_RA, "dec": Device.AXIS_DEC}


def hold_button(client: Client, axis: str, speed_class: str, direction: str, seconds: float) -> Procedure:
    """Move at a speed class while the button is held, then stop."""
    sign = 1 if direction == "+" else -1
    yield from client.ask(AXES[axis], Opcode.SET_CLASS, SpeedClass[speed_class.upper()], sign)
    yield from client.wait(seconds)
    yield from client.ask(AXES[axis], Opcode.STOP)


def set_rate(client: Client, axis: str, rate_arcsec_s: float, seconds: float) -> Procedure:
    """Closed loop at a rate; the rate stays when the time is over."""
    yield from client.ask(AXES[axis], Opcode.SET_RATE, rate_q16(rate_arcsec_s))
    yield from client.wait(seconds)


def open_loop(client: Client, axis: str, effort: float, seconds: float) -> Procedure:
    """Fixed effort (share of the supply, −1..1) with the loop open."""
    yield from client.ask(AXES[axis], Opcode.OPEN_LOOP, round(effort * EFFORT_FULL))
    yield from client.wait(seconds)


def stop(client: Client, axis: str) -> Procedure:
    """Stop one axis or `both`."""
    for name, device in AXES.items():
        if axis in (name, "both"):
            yield from client.ask(device, Opcode.STOP)


def load(client: Client, device: Device, rows: Iterable[tuple[int, int]]) -> Procedure:
    """Set parameters (number, value) in their order; raises `ClientError` if a board keeps another one."""
    count = 0
    for number, value in rows:
        reply = yield from client.ask(device, Opcode.SET_PARAMETER, number, value)
        if reply.value != value:
            raise ClientError(f"{device.name}: parameter {number} is {reply.value}, not {value}")
        count += 1
    client.logs.status(client.now_ns, "HOST", f"{device.name}: {count} parameters loaded")
