"""The focus console: step, move to, hold, free, find the reference (H3)."""

from functools import partial

from bus.protocol import Device, FocusFlag, Opcode
from host.client import Client, ClientError, Procedure

TRAVEL_HALF_STEPS = 800
"""±5 mm at 6.25 µm (P11)."""
_REFERENCE_S = 60.0
_MOVE_S = 60.0
_STEP_S = 2.0


def reference(client: Client) -> Procedure:
    """Find the absolute position from LVDT and index pulse."""
    yield from client.ask(Device.FOCUS, Opcode.FOCUS_REFERENCE)
    yield from client.wait(0.2)
    yield from client.until(
        "FOCUS: referenced",
        lambda: says(client, FocusFlag.REFERENCED) and not says(client, FocusFlag.MOVING),
        _REFERENCE_S,
    )


def move_to(client: Client, half_steps: float) -> Procedure:
    """Move to a position in half steps and wait until the board says it is there."""
    goal = round(half_steps)
    if abs(goal) > TRAVEL_HALF_STEPS:
        raise ClientError(f"FOCUS: {goal} half steps is outside ±{TRAVEL_HALF_STEPS}")
    yield from client.ask(Device.FOCUS, Opcode.FOCUS_MOVE_TO, goal)
    yield from client.until(f"FOCUS: at {goal}", partial(_at, client, goal), _MOVE_S)


def step_by(client: Client, half_steps: float) -> Procedure:
    """Press ±1 as often as asked for."""
    count = round(half_steps)
    for _ in range(abs(count)):
        now = client.focus()
        if now is None:
            raise ClientError("FOCUS: no position has been received yet")
        sign = 1 if count > 0 else -1
        goal = now.position + sign
        yield from client.ask(Device.FOCUS, Opcode.FOCUS_STEP, sign)
        yield from client.until(f"FOCUS: at {goal}", partial(_at, client, goal), _STEP_S)


def set_state(client: Client, state: str) -> Procedure:
    """`hold` (Motor power OFF, regenerative) or `free` (Control Power OFF)."""
    yield from client.ask(Device.FOCUS, Opcode.FOCUS_HOLD if state == "hold" else Opcode.FOCUS_FREE)


def _at(client: Client, goal: int) -> bool:
    now = client.focus()
    return now is not None and now.position == goal and not says(client, FocusFlag.MOVING)


def says(client: Client, flag: FocusFlag) -> bool:
    """Whether the board's last frame has a flag: the motor turns, nothing holds the shaft, ..."""
    now = client.focus()
    return now is not None and bool(now.flags & flag)
