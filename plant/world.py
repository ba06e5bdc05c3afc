"""From a plant model to the world array of the kernels."""

from collections.abc import Mapping
from math import exp

import numpy as np
from numpy.typing import NDArray

from plant.effects.rows import number_from, values, write
from plant.gears import RATIO, TURN
from plant.kernels import layout as at
from plant.parts import AxisModel, PlantModel

AXES = ("ra", "dec")


def grid_ns(model: PlantModel) -> int:
    """Return the grid step, ns."""
    return round(model.numerics.grid.si * 1e9)


def build(model: PlantModel, seed: int, start_angles: Mapping[str, float]) -> NDArray[np.float64]:
    """Return the world at rest at the start angles (rad), one row per axis, teeth in contact."""
    world = np.zeros((len(AXES), at.WIDTH))
    for row, name in zip(world, AXES, strict=True):
        _axis(row, model, getattr(model.axes, name), seed, name, start_angles.get(name, 0.0))
    return world


def _switches(axis: AxisModel) -> dict[str, float]:
    """Return what effects change once: diode share and drop, extra compliance, inertia of swinging masses."""
    changed = {"diode": 0.0, "drop": 0.0, "compliance": 0.0, "swinging": 0.0}
    for effect in axis.effects:
        if not effect.enabled:
            continue
        given = values(effect)
        if effect.name == "diode_braking":
            changed["diode"], changed["drop"] = given["share"], given["drop"]
        elif effect.name == "shaft_compliance":
            changed["compliance"] += given["compliance"]
        elif effect.name == "structural_mode":
            changed["swinging"] += given["inertia"]
    return changed


def _axis(
    w: NDArray[np.float64], model: PlantModel, axis: AxisModel, seed: int, name: str, angle: float
) -> None:
    step = model.numerics.grid.si
    motor, gear, friction, encoders = axis.motor, axis.gear, axis.friction, axis.encoders
    switches = _switches(axis)
    resistance = motor.resistance.si + motor.switch_resistance.si + motor.sense_resistance.si
    inertia = axis.inertia.si - switches["swinging"]
    if inertia <= 0.0:
        raise ValueError(
            f"plant model: axes.{name}.effects: structural_mode swings more than the axis' inertia"
        )

    w[at.GRID] = step
    w[at.INERTIA] = inertia
    w[at.ROTOR_INERTIA] = motor.rotor_inertia.si
    w[at.RATIO] = RATIO
    # Table 1 gives one stiffness per axis: both trains in contact, side by side
    w[at.GEAR_STIFFNESS] = 0.5 / (1.0 / gear.stiffness.si + switches["compliance"])
    w[at.GEAR_DAMPING] = 0.5 * gear.damping.si
    w[at.HALF_PLAY] = 0.5 * gear.backlash.si
    w[at.RESISTANCE] = resistance
    w[at.WINDING] = motor.resistance.si
    w[at.INDUCTANCE] = motor.inductance.si
    w[at.TORQUE_CONSTANT] = motor.torque_constant.si
    w[at.VOLTAGE] = model.supply.voltage.si
    w[at.ROTOR_DRAG] = motor.drag.si
    decay = exp(-resistance * step / motor.inductance.si)
    w[at.CURRENT_DECAY] = decay
    w[at.CURRENT_BLEND] = (1.0 - decay) * motor.inductance.si / (resistance * step)
    w[at.RIPPLE] = model.supply.voltage.si / (2.0 * motor.inductance.si * model.controller.pwm_frequency.si)
    w[at.DIODE], w[at.DIODE_DROP] = switches["diode"], switches["drop"]
    w[at.TEMPERATURE] = model.environment.temperature.si
    w[at.WARMING] = model.environment.warming.si

    f = at.DECLARED_FRICTION
    w[f + at.F_SIGMA0] = friction.bristle_stiffness.si
    w[f + at.F_SIGMA1] = friction.bristle_damping.si
    w[f + at.F_SIGMA2] = friction.viscous.si
    w[f + at.F_COULOMB] = friction.coulomb.si
    w[f + at.F_STICTION] = friction.stiction.si
    w[f + at.F_RATE] = friction.stribeck_rate.si
    w[f + at.F_EXPONENT] = friction.stribeck_exponent.si
    w[f + at.F_DECAY] = friction.bristle_decay.si
    w[at.STRIBECK] = friction.stiction.si / friction.bristle_stiffness.si

    w[at.INCREMENTAL_SCALE] = encoders.incremental.si * encoders.roller_ratio.si / TURN
    w[at.ABSOLUTE_SCALE] = 2.0 ** int(encoders.absolute.si) / TURN
    w[at.AUXILIARY_SCALE] = encoders.auxiliary_ratio.si * 2.0 ** int(encoders.auxiliary.si) / TURN
    w[at.TACH_SCALE] = encoders.tachometer.si / TURN

    w[at.ANGLE] = angle
    w[at.REVERSED_AT] = angle
    # where within a count the incremental encoders wake up is anybody's guess, but always the same one
    w[at.INCREMENTAL_ZERO] = angle - _fraction(seed, f"{name}.incremental") / w[at.INCREMENTAL_SCALE]
    for m, side in enumerate((1.0, -1.0)):
        o = at.MOTORS + m * at.MOTOR_SIZE
        w[o + at.M_ANGLE] = RATIO * (angle + side * w[at.HALF_PLAY])
        w[at.TACH_ZERO + m] = w[o + at.M_ANGLE] - _fraction(seed, f"{name}.tach.{m}") / w[at.TACH_SCALE]
    write(w, axis.effects, constants(axis), seed, name)


def constants(axis: AxisModel) -> dict[str, float]:
    """Return the constants of the plant that formulas of effects may use, SI units."""
    motor = axis.motor
    return {
        "torque_constant": motor.torque_constant.si,
        "resistance": motor.resistance.si + motor.switch_resistance.si + motor.sense_resistance.si,
        "winding": motor.resistance.si,
        "ratio": RATIO,
    }


def _fraction(seed: int, name: str) -> float:
    return number_from(seed, name) / 9007199254740992.0
