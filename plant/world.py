"""From a plant model to the world array of the kernels."""

from collections.abc import Mapping
from math import exp
from operator import attrgetter
from typing import NamedTuple, get_args

import numpy as np

from plant.compiled import Floats, inner
from plant.effects import REGISTRY
from plant.effects.base import Switch
from plant.gears import RATIO
from plant.kernels import layout as at
from plant.parts import AxisModel, Number, PlantModel
from plant.rows import number_from, values, write
from plant.units import TURN

AXES = ("ra", "dec")
_PARTS = {
    "numerics": ("grid",),
    "supply": ("voltage",),
    "environment": ("temperature", "warming"),
    "controller": ("pwm_frequency",),
    "axis": ("inertia",),
    "axis.gear": ("stiffness", "damping", "backlash"),
    "axis.friction": (
        "bristle_stiffness", "bristle_damping", "viscous", "coulomb", "stiction", "stribeck_rate",
        "stribeck_exponent", "bristle_decay",
    ),
    "axis.motor": (
        "torque_constant", "resistance", "inductance", "rotor_inertia", "drag", "switch_resistance",
        "sense_resistance",
    ),
    "axis.encoders": (
        "incremental", "roller_ratio", "absolute", "auxiliary", "auxiliary_ratio", "tachometer"
    ),
}  # fmt: skip
PATHS = {name: f"{part}.{name}" for part, names in _PARTS.items() for name in names}
"""Where in a plant file the declared ones of `Numbers` stand."""


class Numbers(NamedTuple):
    """The declared numbers of one axis, SI units, by their names in a plant file (`PATHS`).

    Then what effects change once: share of freewheel braking; its drop, V; wind-up of the trains, rad/(N m);
    inertia taken off the axis, kg m2. Between them the drop of the power stage's diodes, V, 0: none. Then the
    start: angle, rad, and where within a count the incremental encoders wake up, 0..1.
    """

    grid: float
    voltage: float
    temperature: float
    warming: float
    pwm_frequency: float
    inertia: float
    stiffness: float
    damping: float
    backlash: float
    bristle_stiffness: float
    bristle_damping: float
    viscous: float
    coulomb: float
    stiction: float
    stribeck_rate: float
    stribeck_exponent: float
    bristle_decay: float
    torque_constant: float
    resistance: float
    inductance: float
    rotor_inertia: float
    drag: float
    switch_resistance: float
    sense_resistance: float
    incremental: float
    roller_ratio: float
    absolute: float
    auxiliary: float
    auxiliary_ratio: float
    tachometer: float
    diode: float
    diode_drop: float
    stage_drop: float
    compliance: float
    swinging: float
    angle: float
    incremental_phase: float
    phase_a: float
    phase_b: float


def grid_ns(model: PlantModel) -> int:
    """Return the grid step, ns."""
    return round(model.numerics.grid.si * 1e9)


def build(model: PlantModel, seed: int, start_angles: Mapping[str, float]) -> Floats:
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


@inner
def prepare(w: Floats, n: Numbers) -> None:
    """Fill the parameters of one axis and its state at rest, teeth in contact; the row is zero before."""
    resistance = n.resistance + n.switch_resistance + n.sense_resistance
    w[at.GRID] = n.grid
    w[at.INERTIA] = n.inertia - n.swinging
    w[at.ROTOR_INERTIA] = n.rotor_inertia
    w[at.RATIO] = RATIO
    # Table 1 gives one stiffness per axis: both trains in contact, side by side
    w[at.GEAR_STIFFNESS] = 0.5 / (1.0 / n.stiffness + n.compliance)
    w[at.GEAR_DAMPING] = 0.5 * n.damping
    w[at.HALF_PLAY] = 0.5 * n.backlash
    w[at.RESISTANCE] = resistance
    w[at.WINDING] = n.resistance
    w[at.INDUCTANCE] = n.inductance
    w[at.TORQUE_CONSTANT] = n.torque_constant
    w[at.VOLTAGE] = n.voltage
    w[at.ROTOR_DRAG] = n.drag
    decay = exp(-resistance * n.grid / n.inductance)
    w[at.CURRENT_DECAY] = decay
    w[at.CURRENT_BLEND] = (1.0 - decay) * n.inductance / (resistance * n.grid)
    w[at.RIPPLE] = n.voltage / (2.0 * n.inductance * n.pwm_frequency)
    w[at.DIODE] = n.diode
    w[at.DIODE_DROP] = n.diode_drop
    if n.stage_drop > 0.0:
        w[at.DIODE_DROP] = n.stage_drop
        w[at.PULSE] = 1.0 / (n.pwm_frequency * n.inductance)
    w[at.TEMPERATURE] = n.temperature
    w[at.WARMING] = n.warming

    f = at.DECLARED_FRICTION
    w[f + at.F_SIGMA0] = n.bristle_stiffness
    w[f + at.F_SIGMA1] = n.bristle_damping
    w[f + at.F_SIGMA2] = n.viscous
    w[f + at.F_COULOMB] = n.coulomb
    w[f + at.F_STICTION] = n.stiction
    w[f + at.F_RATE] = n.stribeck_rate
    w[f + at.F_EXPONENT] = n.stribeck_exponent
    w[f + at.F_DECAY] = n.bristle_decay
    w[at.STRIBECK] = n.stiction / n.bristle_stiffness

    w[at.INCREMENTAL_SCALE] = n.incremental * n.roller_ratio / TURN
    w[at.ABSOLUTE_SCALE] = 2.0**n.absolute / TURN
    w[at.AUXILIARY_SCALE] = n.auxiliary_ratio * 2.0**n.auxiliary / TURN
    w[at.TACH_SCALE] = n.tachometer / TURN

    w[at.ANGLE] = n.angle
    w[at.REVERSED_AT] = n.angle
    # where within a count the incremental encoders wake up is anybody's guess, but always the same one
    w[at.INCREMENTAL_ZERO] = n.angle - n.incremental_phase / w[at.INCREMENTAL_SCALE]
    for m in range(2):
        o = at.MOTORS + m * at.MOTOR_SIZE
        side = 1.0 - 2.0 * m
        phase = n.phase_a if m == 0 else n.phase_b
        w[o + at.M_ANGLE] = RATIO * (n.angle + side * w[at.HALF_PLAY])
        w[at.TACH_ZERO + m] = w[o + at.M_ANGLE] - phase / w[at.TACH_SCALE]
