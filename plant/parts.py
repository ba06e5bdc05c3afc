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


def bounds(unit: str, low: float, high: float) -> dict[str, object]:
    """Return the metadata of a field: base unit and bounds in it."""
    return {"unit": unit, "low": low, "high": high}


@dataclass(frozen=True)
class Numerics:
    """The plant's own time grid."""

    grid: Number = field(metadata=bounds("s", 1e-5, 2e-3))


@dataclass(frozen=True)
class Supply:
    """The motors' supply, one for both axes. resistance: of the supply and what both share of its cables."""

    voltage: Number = field(metadata=bounds("V", 1.0, 100.0))
    resistance: Number = field(
        default=Number(0.0, "ohm", "ASSUMPTION: stiff, as nothing is published"),
        metadata=bounds("ohm", 0.0, 1.0),
    )


@dataclass(frozen=True)
class Environment:
    """Ambient temperature: a start and a steady change."""

    temperature: Number = field(metadata=bounds("degC", -60.0, 60.0))
    warming: Number = field(metadata=bounds("K/s", -0.01, 0.01))


@dataclass(frozen=True)
class Controller:
    """The axis board's numbers, fitted together with the plant; gains in PWM steps per count in 5 ms."""

    kp: Number = field(metadata=bounds("steps/count", 0.0, 100.0))
    ki: Number = field(metadata=bounds("steps/count", 0.0, 100.0))
    counter_split: Number = field(metadata=bounds("1", 0.0, 1.0))
    pwm_steps: Number = field(metadata=bounds("steps", 16, 65536))
    pwm_frequency: Number = field(metadata=bounds("Hz", 100.0, 1e6))
    period: Number = field(metadata=bounds("s", 1e-3, 0.1))


@dataclass(frozen=True)
class Gear:
    """Two equal trains between the motors and the bull gear; stiffness is of both together, at the axis."""

    stiffness: Number = field(metadata=bounds("N m/rad", 1e4, 1e9))
    damping: Number = field(metadata=bounds("N m s/rad", 0.0, 1e6))
    backlash: Number = field(metadata=bounds("rad", 0.0, 0.1))


@dataclass(frozen=True)
class Friction:
    """LuGre at the axis. `bristle_decay`: rate at which sigma1 falls by e; 0 for a constant sigma1."""

    coulomb: Number = field(metadata=bounds("N m", 0.0, 1e5))
    stiction: Number = field(metadata=bounds("N m", 0.0, 1e5))
    viscous: Number = field(metadata=bounds("N m s/rad", 0.0, 1e7))
    stribeck_rate: Number = field(metadata=bounds("rad/s", 1e-7, 1.0))
    stribeck_exponent: Number = field(metadata=bounds("1", 0.1, 10.0))
    bristle_stiffness: Number = field(metadata=bounds("N m/rad", 1e4, 1e10))
    bristle_damping: Number = field(metadata=bounds("N m s/rad", 0.0, 1e7))
    bristle_decay: Number = field(metadata=bounds("rad/s", 0.0, 1.0))


@dataclass(frozen=True)
class Motor:
    """One of the two equal motors with its switch and sense resistor; `drag` is viscous, at the rotor.

    diode_drop: forward voltage of the freewheel diodes, with which the power stage is solved period by period
    (plant/kernels/stage.py). None: duty times supply drives the current.
    """

    torque_constant: Number = field(metadata=bounds("N m/A", 0.01, 10.0))
    resistance: Number = field(metadata=bounds("ohm", 0.05, 100.0))
    inductance: Number = field(metadata=bounds("H", 1e-5, 1.0))
    rotor_inertia: Number = field(metadata=bounds("kg m2", 1e-5, 1.0))
    drag: Number = field(metadata=bounds("N m s/rad", 0.0, 1.0))
    switch_resistance: Number = field(metadata=bounds("ohm", 0.0, 10.0))
    sense_resistance: Number = field(metadata=bounds("ohm", 0.0, 10.0))
    diode_drop: Number | None = field(default=None, metadata=bounds("V", 0.01, 1.5))

    @property
    def loop(self) -> float:
        """Resistance of the whole loop, ohm."""
        return self.resistance.si + self.switch_resistance.si + self.sense_resistance.si


@dataclass(frozen=True)
class Encoders:
    """Scales of an axis' encoders, and how far the incremental one rolls per axis turn."""

    incremental: Number = field(metadata=bounds("counts/turn", 100, 1e9))
    roller_ratio: Number = field(metadata=bounds("1", 1.0, 1000.0))
    absolute: Number = field(metadata=bounds("bit", 8, 32))
    auxiliary: Number = field(metadata=bounds("bit", 8, 32))
    auxiliary_ratio: Number = field(metadata=bounds("1", 0.1, 1000.0))
    tachometer: Number = field(metadata=bounds("counts/turn", 4, 1e7))


@dataclass(frozen=True)
class Stops:
    """Hard stops of an axis: true angles where its buffers begin, on the scale of the absolute encoder.

    Stiffness and damping are of one buffer, at the axis. A buffer pushes and never pulls.
    """

    low: Number = field(metadata=bounds("rad", -10.0, 10.0))
    high: Number = field(metadata=bounds("rad", -10.0, 10.0))
    stiffness: Number = field(metadata=bounds("N m/rad", 1e4, 1e9))
    damping: Number = field(metadata=bounds("N m s/rad", 0.0, 1e6))


@dataclass(frozen=True)
class Function:
    """A smooth function found in data (effect `unknown`): knots (x, y) in SI units.

    `motor`: of a target that belongs to a motor, 0 both, 1 A, 2 B.
    """

    target: str
    domain: str
    interpolation: str
    period: float
    knots: tuple[tuple[float, float], ...]
    source: str
    motor: int = 0


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
    """One axis. `inertia` is the load alone: the rotors come on top, rotor_inertia * ratio^2 each.

    stops: None, it turns without end.
    """

    gear: Gear
    friction: Friction
    motor: Motor
    encoders: Encoders
    inertia: Number = field(metadata=bounds("kg m2", 1.0, 1e6))
    effects: tuple[EffectModel, ...] = ()
    stops: Stops | None = None


@dataclass(frozen=True)
class FocusModel:
    """Focus drive: half-stepping motor, belt, ball screw, shaft encoder with index, LVDT."""

    half_steps: Number = field(metadata=bounds("half steps/turn", 4, 1e5))
    belt_ratio: Number = field(metadata=bounds("1", 0.1, 100.0))
    screw_lead: Number = field(metadata=bounds("m/turn", 1e-4, 0.1))
    travel: Number = field(metadata=bounds("m", 1e-4, 1.0))
    settling: Number = field(metadata=bounds("s", 1e-4, 1.0))
    encoder: Number = field(metadata=bounds("counts/turn", 4, 1e6))
    index_width: Number = field(metadata=bounds("counts", 1, 1000))
    lvdt_full_scale: Number = field(metadata=bounds("V", 0.1, 100.0))
    lvdt_gain_error: Number = field(metadata=bounds("1", -0.5, 0.5))
    lvdt_offset: Number = field(metadata=bounds("V", -2.0, 2.0))
    lvdt_nonlinearity: Number = field(metadata=bounds("1", -0.1, 0.1))


def _typical(value: float, most: float, reason: str) -> Any:
    source = f"ASSUMPTION: typical of a 50 cm mount; {reason}"
    return field(default=Number(value, "arcsec", source), metadata=bounds("arcsec", -most, most))


@dataclass(frozen=True, kw_only=True)
class MountErrors:
    """Errors between the axes and the sky (plant/mount.py). A number that is not given is typical.

    Signs are Wallace's: what the axes read less where the telescope looks. So a pointing model finds these
    numbers under the names in brackets. An encoder off its centre is here a matter of pointing: the
    drive does not feel a slope of 5e-6. The effect `encoder_eccentricity` is in the readings themselves.
    """

    hour_angle_index: Number = _typical(240.0, 3600.0, "a zero set by eye, IH")
    declination_index: Number = _typical(-180.0, 3600.0, "a zero set by eye, ID")
    polar_azimuth: Number = _typical(90.0, 3600.0, "aligned by drift, MA")
    polar_altitude: Number = _typical(-120.0, 3600.0, "aligned by drift, ME")
    collimation: Number = _typical(60.0, 1800.0, "0.3 mm at the plate holder's 1 m, CH")
    non_perpendicularity: Number = _typical(-30.0, 1800.0, "bearings bored within 0.15 mm over 1 m, NP")
    tube_flexure: Number = _typical(-20.0, 300.0, "a steel tube; below zero it droops, TF")
    fork_flexure: Number = _typical(12.0, 300.0, "half of the tube's, FO")
    axis_flexure: Number = _typical(8.0, 300.0, "held at both ends by the yoke, DAF")
    hour_angle_eccentricity: Number = _typical(
        1.0, 60.0, "the RCN 829's catalogue has ±1 arcsec; times sin h, HCES"
    )
    declination_eccentricity: Number = _typical(1.0, 60.0, "as in hour angle; times sin dec, DCES")
    refraction: Number = _typical(2.0, 60.0, "4 % of 46 arcsec at 1950 m: air 10 K off; times tan z, TX")


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
    mount: MountErrors | None = None
    """None: axes perpendicular, on the pole, stiff."""
