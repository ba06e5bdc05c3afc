"""What the telescope looks like at one moment, as plain values that any thread may read."""

from typing import NamedTuple

from bus.protocol import (
    AxisMode,
    Device,
    Focus,
    Health,
    MotionFlag,
    State,
    unpack_tach,
    unpack_target,
)
from host.auxiliary import Auxiliary, auxiliary
from host.client import SILENCE_NS, TICK_NS, Client
from host.rates import CURRENT_A_PER_COUNT, EFFORT_FULL, rate_arcsec_s
from host.sky.mount import STEP_ARCSEC

_TACH_PERIOD_S = 0.01
_TACH_COUNTS = 4096
_PERIOD_NS = {
    "POSITION": 5_000_000, "AXIS": 10_000_000, "MOTOR": 10_000_000, "FOCUS": 50_000_000,
    "AUXILIARY": 10_000_000, "DOME": 100_000_000, "POWER": 250_000_000, "WEATHER": 1_000_000_000,
}  # fmt: skip
"""Of their measurement frames (docs/reference/protocol.md)."""
MISSED = 5
"""Frames in a row that may be late or lost before a value is called old. ASSUMPTION."""
AXES = {
    "ra": (Device.AXIS_RA, Device.POSITION_RA, Device.MOTOR_RA_A, Device.MOTOR_RA_B),
    "dec": (Device.AXIS_DEC, Device.POSITION_DEC, Device.MOTOR_DEC_A, Device.MOTOR_DEC_B),
}
"""Boards of each axis: controller, encoder, motors A and B."""


class AxisState(NamedTuple):
    """One axis. None where no frame has come yet. `latched_s`: when the encoder was read."""

    steps: int | None
    latched_s: float
    mode: AxisMode
    powered: bool
    moving: bool
    soft_limit: bool
    fault: bool
    rate_arcsec_s: float
    effort: float
    """Share of the supply, −1..1; positive: motor A leads."""
    currents_a: tuple[float, float]
    motor_turns_s: tuple[float | None, float | None]
    to_go_arcsec: float
    auxiliary: Auxiliary | None = None
    """The auxiliary encoder at `latched_s`; None: no board, or nothing of it yet."""


class BoardState(NamedTuple):
    """One board as its heartbeat shows it; `health` is the answer to the last PING, None before one."""

    device: Device
    alive: bool
    state: State | None
    overruns: int
    tec: int
    health: Health | None


class Snapshot(NamedTuple):
    """Everything at one tick."""

    t_s: float
    ra: AxisState
    dec: AxisState
    focus: Focus | None
    """Half steps of 6.25 µm, encoder counts, LVDT in ADC counts (0..1023)."""
    boards: tuple[BoardState, ...]
    activity: str
    powered: bool
    slewing: bool
    """On the way to a target or to the park position, or moved by hand."""
    tracking: bool
    """Tracking is on: what the axes do, or go back to when a slew or a stop has ended."""
    parked: bool
    pulse_guiding: bool
    target: str
    errors_arcsec: tuple[float, float] | None
    """Target less encoder, hour angle and declination."""
    locked: bool
    stale: frozenset[Device] = frozenset()
    """Boards whose last measurement is older than it may be."""


def axis_state(client: Client, name: str) -> AxisState:
    """One axis from the last frames."""
    board, encoder, *motors = AXES[name]
    motion, reading = client.motion(board), client.position(encoder)
    summary = client.link.summaries.get(board)
    tachs = [client.link.measurements.get(motor) for motor in motors]
    turns = [unpack_tach(data).delta / _TACH_COUNTS / _TACH_PERIOD_S if data else None for data in tachs]
    steps = reading.position if reading else None
    latched_s = client.latched_s(encoder, reading) if reading else 0.0
    flags = MotionFlag(motion.flags) if motion else MotionFlag(0)
    rate = rate_arcsec_s(motion.velocity) if motion else 0.0
    return AxisState(
        steps=steps,
        latched_s=latched_s,
        mode=AxisMode(motion.mode) if motion and motion.mode in _MODES else AxisMode.OFF,
        powered=bool(flags & MotionFlag.POWERED),
        moving=bool(flags & MotionFlag.MOVING),
        soft_limit=bool(flags & MotionFlag.SOFT_LIMIT),
        fault=bool(flags & MotionFlag.FAULT),
        rate_arcsec_s=rate,
        effort=motion.effort / EFFORT_FULL if motion else 0.0,
        currents_a=(
            (motion.adc_a * CURRENT_A_PER_COUNT, motion.adc_b * CURRENT_A_PER_COUNT) if motion else (0.0, 0.0)
        ),
        motor_turns_s=(turns[0], turns[1]),
        to_go_arcsec=unpack_target(summary).distance * STEP_ARCSEC if summary else 0.0,
        auxiliary=auxiliary(client.link, name, steps, latched_s, rate),
    )


def board_states(client: Client) -> tuple[BoardState, ...]:
    """Every board that is expected to live."""
    states = []
    for device in client.devices:
        beat = client.heartbeat(device)
        heard_ns = client.link.heard_ns.get(device, -SILENCE_NS)
        states.append(
            BoardState(
                device=device,
                alive=beat is not None and client.now_ns - heard_ns <= SILENCE_NS,
                state=State(beat.state) if beat and beat.state in _STATES else None,
                overruns=beat.overruns if beat else 0,
                tec=beat.tec if beat else 0,
                health=client.health.get(device),
            )
        )
    return tuple(states)


def stale_boards(client: Client) -> frozenset[Device]:
    """Boards whose measurement has not come for `MISSED` of its periods, and a tick."""
    return frozenset(
        device
        for device in client.devices
        if (period_ns := _PERIOD_NS.get(device.name.partition("_")[0])) is not None
        and client.now_ns - client.link.measured_ns.get(device, 0) > MISSED * period_ns + TICK_NS
    )


_MODES = {int(mode) for mode in AxisMode}
_STATES = {int(state) for state in State}
