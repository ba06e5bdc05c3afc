"""From a plant model to the world array of the kernels."""

from collections.abc import Mapping
from operator import attrgetter
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from plant.effects import REGISTRY
from plant.effects.base import Switch
from plant.gears import RATIO
from plant.kernels import layout as at
from plant.kernels.prepare import Numbers, prepare
from plant.parts import AxisModel, Number, PlantModel
from plant.rows import number_from, values, write

AXES = ("ra", "dec")
_PARTS = {
    "numerics": ("grid",),
    "supply": ("voltage",),
    "environment": ("temperature", "warming"),
    "controller": ("pwm_frequency",),
    "axis": ("inertia",),
    "axis.gear": ("stiffness", "damping", "backlash"),
    "axis.motor": (
        "torque_constant", "resistance", "inductance", "rotor_inertia", "drag", "switch_resistance",
        "sense_resistance",
    ),
    "axis.encoders": (
        "incremental", "roller_ratio", "absolute", "auxiliary", "auxiliary_ratio", "tachometer"
    ),
    "axis.friction": (
        "bristle_stiffness", "bristle_damping", "viscous", "coulomb", "stiction", "stribeck_rate",
        "stribeck_exponent", "bristle_decay",
    ),
}  # fmt: skip
PATHS = {name: f"{part}.{name}" for part, names in _PARTS.items() for name in names}
"""Where in a plant file the declared ones of `Numbers` stand."""


def grid_ns(model: PlantModel) -> int:
    """Return the grid step, ns."""
    return round(model.numerics.grid.si * 1e9)


def build(model: PlantModel, seed: int, start_angles: Mapping[str, float]) -> NDArray[np.float64]:
    """Return the world at rest at the start angles (rad), one row per axis, teeth in contact."""
    world = np.zeros((len(AXES), at.WIDTH))
    world[:, at.SUPPLY_RESISTANCE] = model.supply.resistance.si
    for row, name in zip(world, AXES, strict=True):
        axis: AxisModel = getattr(model.axes, name)
        prepare(row, numbers_of(model, name, seed, start_angles.get(name, 0.0)))
        if row[at.INERTIA] <= 0.0:
            raise ValueError(f"plant model: axes.{name}.effects: more swings than the axis' inertia")
        write(row, axis.effects, constants(axis), seed, name)
        if (stops := axis.stops) is not None:
            low, high = stops.low.si, stops.high.si
            row[at.STOP_MIDDLE], row[at.STOP_REACH] = 0.5 * (low + high), 0.5 * (high - low)
            row[at.STOP_STIFFNESS], row[at.STOP_DAMPING] = stops.stiffness.si, stops.damping.si
    return world


def declared(model: PlantModel, axis: str) -> dict[str, Number]:
    """Return the declared numbers of an axis, by their names in `Numbers`."""
    return {name: attrgetter(path.replace("axis", f"axes.{axis}", 1))(model) for name, path in PATHS.items()}


def numbers_of(model: PlantModel, name: str, seed: int, angle: float) -> Numbers:
    """Return what the row of an axis is made of, at the start angle, rad."""
    axis: AxisModel = getattr(model.axes, name)
    return Numbers(
        **{word: number.si for word, number in declared(model, name).items()},
        **_switches(axis),
        stage_drop=axis.motor.diode_drop.si if axis.motor.diode_drop else 0.0,
        angle=angle,
        incremental_phase=_fraction(seed, f"{name}.incremental"),
        phase_a=_fraction(seed, f"{name}.tach.0"),
        phase_b=_fraction(seed, f"{name}.tach.1"),
    )


def _switches(axis: AxisModel) -> dict[str, float]:
    """Return what effects change once, summed."""
    changed = dict.fromkeys(get_args(Switch), 0.0)
    for effect in axis.effects:
        if effect.enabled:
            given = values(effect)
            for parameter, switch in REGISTRY[effect.name].switches.items():
                changed[switch] += given[parameter]
    return changed


def constants(axis: AxisModel) -> dict[str, float]:
    """Return the constants of the plant that formulas of effects may use, SI units."""
    motor = axis.motor
    return {
        "torque_constant": motor.torque_constant.si,
        "resistance": motor.loop,
        "winding": motor.resistance.si,
        "ratio": RATIO,
    }


def _fraction(seed: int, name: str) -> float:
    return number_from(seed, name) / 9007199254740992.0
