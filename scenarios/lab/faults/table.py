"""The table of faults: what table.yaml tells of each, with the code that does it."""

from functools import partial
from pathlib import Path
from typing import Any

import yaml

from plant.kernels import layout as at
from scenarios.lab.faults import onboard, onbus, onchip, onplant, onsensor
from scenarios.lab.faults.kind import Kind, Make, Parameter

_FRICTION = (at.DECLARED_FRICTION + at.F_COULOMB, at.DECLARED_FRICTION + at.F_STICTION)
MAKE: dict[str, Make] = {
    "bit_errors": onbus.BitErrors,
    "babbler": onbus.Babbler,
    "partition": onbus.Cut,
    "wrong_bitrate": onbus.WrongRate,
    "duplicate_node": onbus.Twin,
    "forged_sender": onbus.Forger,
    "stuck_dominant": onbus.Dominant,
    "node_off": onboard.NoSupply,
    "brown_out": onboard.BrownOut,
    "reset": onboard.Resets,
    "hang": onboard.Hang,
    "crystal_drift": onboard.Drift,
    "late_interrupts": onboard.LateInterrupts,
    "frame_loss": onchip.FrameLoss,
    "deaf_controller": lambda place, given, _: onboard.Hears(place, place.board(given["node"]).port),
    "endat_line": onchip.EndatLine,
    "serial_noise": onchip.SerialNoise,
    "pwm_stuck": onchip.PwmStuck,
    "sensor_stuck": onsensor.Stuck,
    "sensor_noise": onsensor.Off,
    "sensor_bias": onsensor.Off,
    "sensor_scale": onsensor.Off,
    "sensor_delayed": onsensor.Delayed,
    "sensor_intermittent": onsensor.Intermittent,
    "motor_open": partial(onplant.OneDuty, 0.0),
    "mosfet_short": partial(onplant.OneDuty, 1.0),
    "emergency_stop": onplant.EmergencyStop,
    "weak_supply": partial(onplant.WeakSupply, (at.VOLTAGE, at.RIPPLE)),
    "friction_change": partial(onplant.Turned, _FRICTION),
    "load_change": partial(onplant.Turned, (at.INERTIA,)),
    "play_change": partial(onplant.Play, (at.HALF_PLAY,)),
}
"""Who starts each fault."""


def _kind(name: str, row: dict[str, Any]) -> Kind:
    parameters = tuple(Parameter(each, **given) for each, given in row.pop("arguments", {}).items())
    one_of = tuple(row.pop("one_of", ()))
    return Kind(name=name, parameters=parameters, make=MAKE[name], one_of=one_of, **row)


_ROWS: dict[str, Any] = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8"))
KINDS: tuple[Kind, ...] = tuple(_kind(name, row) for name, row in _ROWS.items())
BY_NAME = {kind.name: kind for kind in KINDS}
