"""compensation.yaml: what a host may load into an axis board, so that its loop need not wait for the error.

Waves of the torque over the position, as effort against them, and the level at which friction turns. All
of it from a plant file, for slow motion in the direction of tracking (+), with that motion's windup and
currents.
"""

from dataclasses import dataclass
from math import exp
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray

from plant.deadzone import bias_steps, dead_zone, step_amperes, step_torque
from plant.effects import REGISTRY
from plant.effects import signals as sig
from plant.effects.signals import Hook
from plant.evaluate import evaluate, signals
from plant.gears import RATIO
from plant.parts import AxisModel, EffectModel, PlantModel
from plant.rows import values
from plant.units import ARCSEC, TURN

FORMAT = "schmidt-compensation 1"
LINES = 8
"""Rows of an axis board's table (bus/protocol/names.py; a test holds the two together). definition."""
RATE = 15.041 * ARCSEC
"""rad/s: the tracking rate, for which friction and currents are taken."""
LEAST_STEPS = 0.05
"""Waves below this are left out, PWM steps: 0.07 N m at the axis, less than half the smallest
declared. ASSUMPTION."""
_POINTS = 256
"""Points of a wave; arithmetic, rounding is all that is left of a sine."""
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Drive:
    """What the drive does at the tracking rate.

    per_step: N m at the axis per PWM step of effort, counter torque taken off. friction: N m. travel: rad in
    which friction turns. motors: angle each motor leads the axis by, rad at the axis. currents: A.
    """

    per_step: float
    friction: float
    travel: float
    motors: tuple[float, float]
    currents: tuple[float, float]


def drive_of(model: PlantModel, axis: AxisModel) -> Drive:
    """Work out the steady state at the tracking rate."""
    f, motor, controller = axis.friction, axis.motor, model.controller
    share = exp(-((RATE / f.stribeck_rate.si) ** f.stribeck_exponent.si))
    level = f.coulomb.si + (f.stiction.si - f.coulomb.si) * share
    amperes, newton = step_amperes(model, motor), step_torque(model, motor)  # EMF apart
    split = controller.counter_split.si
    per_step = newton * (1.0 - split)
    friction = level + f.viscous.si * RATE
    effort = friction / per_step
    dead = controller.pwm_steps.si * sum(
        values(each)["deadband"] for each in axis.effects if each.enabled and each.name == "pwm_deadband"
    )
    dead += dead_zone(model, motor) * controller.pwm_steps.si
    bias = bias_steps(model, motor)
    duties = [max(0.0, duty + bias - dead) for duty in (effort, split * effort)]
    half, each = 0.5 * axis.gear.backlash.si, 0.5 * axis.gear.stiffness.si
    lead, lag = (half + newton * duty / each for duty in duties)
    return Drive(per_step, friction, level / f.bristle_stiffness.si, (lead, -lag),
                 (amperes * duties[0], amperes * duties[1]))  # fmt: skip


def _on_axis(effect: EffectModel, angle: Floats, axis: AxisModel) -> Floats:
    f = axis.friction
    steady = {
        sig.RATE: RATE, sig.SIGMA0: f.bristle_stiffness.si, sig.SIGMA2: f.viscous.si,
        sig.COULOMB: f.coulomb.si, sig.STICTION: f.stiction.si, sig.STRIBECK_RATE: f.stribeck_rate.si,
        sig.STRIBECK_EXPONENT: f.stribeck_exponent.si,
    }  # fmt: skip
    given = {sig.ANGLE: angle} | {place: np.full_like(angle, number) for place, number in steady.items()}
    return evaluate(effect.name, signals(len(angle), given), values(effect))


def _on_motors(effect: EffectModel, angle: Floats, drive: Drive, axis: AxisModel) -> Floats:
    total = np.zeros_like(angle)
    constant = axis.motor.torque_constant.si
    for m, side in enumerate((1.0, -1.0)):
        given = {sig.MOTOR_ANGLE: RATIO * (angle + drive.motors[m]), sig.MOTOR: np.full_like(angle, m)}
        change = evaluate(effect.name, signals(len(angle), given), values(effect))
        if REGISTRY[effect.name].terms[0].hook is Hook.CONSTANT:
            change = side * constant * drive.currents[m] * change
        total += RATIO * change
    return total


def lines(model: PlantModel, axis_name: str) -> tuple[list[dict[str, float | str]], list[str]]:
    """Rows of the table, strongest first, and what could not be put into it."""
    axis: AxisModel = getattr(model.axes, axis_name)
    drive = drive_of(model, axis)
    rows: list[tuple[float, dict[str, float | str]]] = []
    left: list[str] = []
    for effect in axis.effects:
        if not effect.enabled:
            continue
        spec = REGISTRY[effect.name]
        if not spec.wave:
            if "T" in spec.channel:
                left.append(f"{effect.name}: not a wave of torque over the position")
            continue
        numbers = values(effect)
        order = numbers["cycles"] * RATIO if "cycles" in numbers else numbers.get("order", 1.0)  # per turn
        angle: Floats = np.arange(_POINTS, dtype=np.float64) * (TURN / order / _POINTS)
        of_motors = spec.terms[0].of_motors
        wave = _on_motors(effect, angle, drive, axis) if of_motors else _on_axis(effect, angle, axis)
        cosine, sine = (float(2.0 * np.mean(wave * turn(order * angle))) for turn in (np.cos, np.sin))
        size = float(np.hypot(cosine, sine))
        where = f" on {effect.stage}, harmonic {effect.harmonic}" if effect.stage else ""
        if size / drive.per_step < LEAST_STEPS:
            if size:
                left.append(f"{effect.name}{where}: {size:.2g} N m is too little")
            continue
        row: dict[str, float | str] = {
            "order": round(order, 6),
            "cosine_steps": round(-cosine / drive.per_step, 4),
            "sine_steps": round(-sine / drive.per_step, 4),
            "torque_Nm": round(size, 3),
            "source": f"{effect.name}{where}",
        }
        rows.append((size, row))
    rows.sort(key=lambda each: -each[0])
    left += [f"{row['source']}: the table has {LINES} lines" for _, row in rows[LINES:]]
    return [row for _, row in rows[:LINES]], left


def write(file: Path, model: PlantModel, axis_name: str) -> list[str]:
    """Write the compensation of one axis of a plant; returns what was left out of it."""
    drive = drive_of(model, getattr(model.axes, axis_name))
    rows, left = lines(model, axis_name)
    data = {
        "format": FORMAT,
        "axis": axis_name,
        "plant": model.name,
        "lines": rows,
        "friction": {
            "steps": round(drive.friction / drive.per_step, 3),
            "travel_arcsec": round(drive.travel / ARCSEC, 3),
            "source": f"friction at {RATE / ARCSEC:g} arcsec/s, {drive.friction:.1f} N m",
        },
        "left_out": left,
    }
    head = "# Loaded by schmidt run --compensation. Effort in PWM steps over the absolute encoder's angle.\n"
    file.write_text(head + yaml.safe_dump(data, sort_keys=False, width=110), encoding="utf-8")
    return left
