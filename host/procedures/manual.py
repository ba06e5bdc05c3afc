"""Buttons of the main console: power, speed classes, rates, open loop, stop, parameters (H2, B2)."""

from collections.abc import Iterable
from functools import partial

from bus.protocol import AxisParameter, Device, Health, MotionFlag, Opcode, SpeedClass
from bus.protocol.scales import rate_q16
from host.client import Client, ClientError, Procedure
from host.rates import EFFORT_FULL

AXES = {"ra": Device.AXIS_RA, "dec": Device.AXIS_DEC}
BOARDS = tuple(AXES.values())


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


_HEALTH_PATIENCE_S = 5.0
"""Boards may report stale data until the first frames of the others have come in. ASSUMPTION."""
_POWER_S = 2.0


def health_check(client: Client) -> Procedure:
    """Ask every board for its health bits until all are zero; raises `ClientError` naming the others."""
    end_ns = client.now_ns + round(_HEALTH_PATIENCE_S * 1e9)
    ill = list(client.devices)
    bits: dict[Device, int] = {}
    while ill:
        for device in ill:
            reply = yield from client.ask(device, Opcode.PING)
            bits[device] = reply.value
        ill = [device for device in ill if bits[device]]
        if ill and client.now_ns > end_ns:
            words = "; ".join(f"{device.name} reports {_words(bits[device])}" for device in ill)
            raise ClientError(f"health check: {words}")
        yield
    client.logs.status(client.now_ns, "HOST", f"health check passed, {len(client.devices)} boards")


def power_on(client: Client, check: bool = True, dec_bias_q8: int = 0) -> Procedure:
    """Health check, then switch both axes on and wait until they say so.

    dec_bias_q8: duty that both motors of declination then always get, PWM steps in Q8; 0: as the board has
    it. Switched on later, it would throw the axis by the lagging motor's play.
    """
    if check:
        yield from health_check(client)
    if dec_bias_q8:
        bias = AxisParameter.COUNTER_BIAS_Q8, dec_bias_q8
        yield from client.ask(Device.AXIS_DEC, Opcode.SET_PARAMETER, *bias)
    for axis in BOARDS:
        yield from client.ask(axis, Opcode.POWER, 1)
    for axis in BOARDS:
        yield from client.until(f"{axis.name}: powered", partial(powered, client, axis), _POWER_S)


def power_off(client: Client) -> Procedure:
    """Switch both axes off; they should be at rest."""
    for axis in BOARDS:
        yield from client.ask(axis, Opcode.POWER, 0)


def powered(client: Client, axis: Device) -> bool:
    """Whether an axis board says that its outputs are on."""
    motion = client.motion(axis)
    return motion is not None and bool(motion.flags & MotionFlag.POWERED)


def _words(bits: int) -> str:
    return ", ".join(flag.name.lower() for flag in Health if bits & flag and flag.name) or hex(bits)
