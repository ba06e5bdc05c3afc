"""The parts of a plant model: frozen records of numbers with unit and source. Bounds are in the base unit."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from plant.units import to_si


@dataclass(frozen=True)
class Number:
    """One declared number: value in `unit`, and where it comes from."""

    value: float
    unit: str
    source: str

    @property
    def si(self) -> float:
        """The value in the base unit (plant/units.py)."""
        return to_si(self.value, self.unit)


def number(unit: str, low: float, high: float) -> Any:
    """Declare a field of a part: base unit and bounds in it."""
    return field(metadata={"unit": unit, "low": low, "high": high})


@dataclass(frozen=True)
class Numerics:
    """The plant's own time grid."""

    grid: Number = number("s", 1e-5, 2e-3)


@dataclass(frozen=True)
class Supply:
    """The motors' supply."""

    voltage: Number = number("V", 1.0, 100.0)


@dataclass(frozen=True)
class Environment:
    """Ambient temperature: a start and a steady change."""

    temperature: Number = number("degC", -60.0, 60.0)
    warming: Number = number("K/s", -0.01, 0.01)


@dataclass(frozen=True)
class Controller:
    """The axis board's numbers that were fitted together with the plant; gains in PWM steps per count in 5 ms."""

    kp: Number = number("steps/count", 0.0, 100.0)
    ki: Number = number("steps/count", 0.0, 100.0)
    counter_split: Number = number("1", 0.0, 1.0)
    pwm_steps: Number = number("steps", 16, 65536)
    pwm_frequency: Number = number("Hz", 100.0, 1e6)
    period: Number = number("s", 1e-3, 0.1)


@dataclass(frozen=True)
class Gear:
    """Two equal trains between the motors and the bull gear; stiffness is of both together, at the axis."""

    stiffness: Number = number("N m/rad", 1e4, 1e9)
    damping: Number = number("N m s/rad", 0.0, 1e6)
    backlash: Number = number("rad", 0.0, 0.1)


@dataclass(frozen=True)
class Friction:
    """LuGre at the axis. `bristle_decay`: rate at which sigma1 falls by e; 0 for a constant sigma1."""

    coulomb: Number = number("N m", 0.0, 1e5)
    stiction: Number = number("N m", 0.0, 1e5)
    viscous: Number = number("N m s/rad", 0.0, 1e7)
    stribeck_rate: Number = number("rad/s", 1e-7, 1.0)
    stribeck_exponent: Number = number("1", 0.1, 10.0)
    bristle_stiffness: Number = number("N m/rad", 1e4, 1e10)
    bristle_damping: Number = number("N m s/rad", 0.0, 1e7)
    bristle_decay: Number = number("rad/s", 0.0, 1.0)


@dataclass(frozen=True)
class Motor:
    """One of the two equal motors with its switch and sense resistor; `drag` is viscous, at the rotor."""

    torque_constant: Number = number("N m/A", 0.01, 10.0)
    resistance: Number = number("ohm", 0.05, 100.0)
    inductance: Number = number("H", 1e-5, 1.0)
    rotor_inertia: Number = number("kg m2", 1e-5, 1.0)
    drag: Number = number("N m s/rad", 0.0, 1.0)
    switch_resistance: Number = number("ohm", 0.0, 10.0)
    sense_resistance: Number = number("ohm", 0.0, 10.0)


@dataclass(frozen=True)
class Encoders:
    """Scales of an axis' encoders, and how far the incremental one rolls per axis turn."""

    incremental: Number = number("counts/turn", 100, 1e9)
    roller_ratio: Number = number("1", 1.0, 1000.0)
    absolute: Number = number("bit", 8, 32)
    auxiliary: Number = number("bit", 8, 32)
    auxiliary_ratio: Number = number("1", 0.1, 1000.0)
    tachometer: Number = number("counts/turn", 4, 1e7)


@dataclass(frozen=True)
class Function:
    """A smooth function found in data (effect `unknown`): knots (x, y) in SI units."""

    target: str
    domain: str
    interpolation: str
    period: float
    knots: tuple[tuple[float, float], ...]
    source: str


@dataclass(frozen=True)
class EffectModel:
    """One effect of an axis; parameters that are not given take the effect's defaults."""

    name: str
    stage: str | None = None
    harmonic: int = 1
    parameters: Mapping[str, Number] = field(default_factory=dict)
    function: Function | None = None
    enabled: bool = True


@dataclass(frozen=True)
class AxisModel:
    """One axis. `inertia` is the load alone: the rotors come on top, rotor_inertia * ratio^2 each."""

    gear: Gear
    friction: Friction
    motor: Motor
    encoders: Encoders
    inertia: Number = number("kg m2", 1.0, 1e6)
    effects: tuple[EffectModel, ...] = ()


@dataclass(frozen=True)
class FocusModel:
    """Focus drive: half-stepping motor, belt, ball screw, shaft encoder with index, LVDT."""

    half_steps: Number = number("half steps/turn", 4, 1e5)
    belt_ratio: Number = number("1", 0.1, 100.0)
    screw_lead: Number = number("m/turn", 1e-4, 0.1)
    travel: Number = number("m", 1e-4, 1.0)
    settling: Number = number("s", 1e-4, 1.0)
    encoder: Number = number("counts/turn", 4, 1e6)
    index_width: Number = number("counts", 1, 1000)
    lvdt_full_scale: Number = number("V", 0.1, 100.0)
    lvdt_gain_error: Number = number("1", -0.5, 0.5)
    lvdt_offset: Number = number("V", -2.0, 2.0)
    lvdt_nonlinearity: Number = number("1", -0.1, 0.1)


@dataclass(frozen=True)
class Axes:
    """The two axes."""

    ra: AxisModel
    dec: AxisModel


@dataclass(frozen=True)
class PlantModel:
    """Everything about the machine that the emulator needs; see plant/files/*.yaml."""

    name: str
    description: str
    numerics: Numerics
    supply: Supply
    environment: Environment
    controller: Controller
    axes: Axes
    focus: FocusModel
