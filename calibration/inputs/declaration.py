"""A drive as its rig file declares it (rig.schema.json); fields bear the file's keys, without SI units."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, is_dataclass
from pathlib import Path
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from calibration.inputs.thresholds import DEFAULT_HOLD_OUT
from calibration.inputs.units import is_rate
from plant.effects import REGISTRY

#: channels whose response is a balance of forces; the others compare one sensor with another
FORCES = ("effort", "force", "current", "applied", "acceleration", "velocity")
JOINTS = ("joint", "joint2", "joint3")  # channels of other joints' angles, which a weight is carried over
_UNIT = re.compile(r"_(Nms?(_per_\w+)?|rad_per_s|ohm|kgm2)$")  # the SI unit at the end of a key
T = TypeVar("T")


def made(kind: type[T], given: Mapping[str, Any], **more: Any) -> T:
    """The dataclass `kind` of a file's mapping, without keys that are no field; `more` are fields as such."""
    hints = get_type_hints(kind)
    named = {key if key in hints else _UNIT.sub("", key): value for key, value in given.items()}
    found = {name: _as(hints[name], value) for name, value in named.items() if name in hints.keys() - more}
    return kind(**found, **more)


def _as(hint: Any, value: Any) -> Any:
    """A file's value as a field has it: integer as float, list as tuple, mapping as the dataclass."""
    kinds = get_args(hint) or (hint,)
    if isinstance(value, list):
        return tuple(_as(kinds[0], x) for x in value)
    if isinstance(value, dict) and get_origin(hint) is dict:
        return {key: _as(kinds[1], x) for key, x in value.items()}
    if isinstance(value, dict):
        record: Any = next(k for k in kinds if is_dataclass(k))
        return made(record, value)
    return float(value) if float in kinds else value


@dataclass(frozen=True)
class Column:
    """Where a channel is in the file, its unit, and the factor to the rig's unit."""

    unit: str
    column: str | int = ""  # none: `files` and `steps` say it
    scale: float = 1.0
    offset: float = 0.0  # rig units, added after the scale
    wrap: float | None = None  # length of the counter, file units
    delay_s: float = 0.0  # known lateness, taken out
    window_s: float | None = None  # over which a counted rate counts, up to the row's stamp
    format: str = ""  # of stamps that are no numbers: iso, or strptime's
    clock: str | int = ""  # the column that holds the clock of such a stamp's day
    sign_bit: int | None = None  # of sign-magnitude words, from 0
    files: dict[str, float] = field(default_factory=dict)  # a factor per file, by the name's pattern
    steps: tuple[tuple[float, float], ...] = ()  # (s, factor from then on)
    integrated: bool = False  # over time, after all that


GUESSED = "unknown"  # kind of a stage of which nobody said whether it is a gear or a motor


@dataclass(frozen=True)
class Stage:
    """A rotating part: its period in position units; `period_s` for a drive at constant rate."""

    name: str
    period: float | None
    period_s: float | None
    harmonics: int
    kind: str | None
    listed: tuple[int, ...] = ()  # the only ones that are looked for

    @property
    def orders(self) -> tuple[int, ...]:
        """Its harmonics that are looked for."""
        return tuple(h for h in self.listed or range(1, self.harmonics + 1) if h <= self.harmonics)

    @property
    def declared(self) -> str | None:
        """Name of its lines, where the rig file knows it."""
        return None if self.kind == GUESSED else self.kind

    @property
    def of_motor(self) -> bool:
        """Whether it is a motor: its shaft, or what its torque does over its angle."""
        effect = REGISTRY.get(self.declared or "")
        return self.kind == "motor" or (effect is not None and effect.domain == "motor_angle")


@dataclass(frozen=True)
class Response:
    """What a balance explains: `gain` times a column, in `unit`, over the column `divide_by` where given."""

    channel: str
    unit: str
    gain: float = 1.0
    divide_by: str | None = None
    ratio: float | None = None  # of a second sensor to the first; None: estimated

    @property
    def is_force(self) -> bool:
        """True for a balance of forces or a speed, False for one sensor against another."""
        return self.channel in FORCES

    @property
    def is_speed(self) -> bool:
        """True for a speed, whatever its column is called: no balance, so only lines are looked for in it."""
        return self.channel == "velocity" or (self.is_force and is_rate(self.unit))


@dataclass(frozen=True)
class Controller:
    """The loop's law, `pid` (p, i, d) or `cascade` (position, velocity), and its gains, feed-forward too."""

    law: str
    gains: dict[str, float]
    limit: float | None = None  # of the effort, its unit: at it the law is not what acts


@dataclass(frozen=True)
class Motors:
    """Two motors that pull an axis against each other, through trains of their own; SI."""

    counter_torque: float  # share of the effort that the lagging motor gets
    torque_constant: float  # N m/A
    resistance: float  # ohm, of the whole loop
    rotor_inertia: tuple[float, float]  # kg m2 at the motor, least and most
    train_stiffness: float  # N m/rad at the axis, of one train
    stiffness_readings: tuple[float, ...] = (1.0,)  # factors that number may have to be read by


@dataclass(frozen=True)
class Friction:
    """LuGre friction with a Stribeck curve, as declared for one state of a drive; SI at the axis."""

    coulomb: float
    stiction: float
    stribeck_rate: float
    viscous: float
    bristle_stiffness: float
    stribeck_exponent: float = 2.0
    state: str = ""


@dataclass(frozen=True)
class FrictionLaw:
    """Shape of the friction of a drive with one motor, whose size is the term `coulomb`: a dip from rest
    (Stribeck), bristles (LuGre), or both. Position units and s."""

    stiction_ratio: float = 1.0  # friction from rest over Coulomb's
    stribeck_speed: float = 1.0
    stribeck_exponent: float = 2.0
    bristle_travel: float | None = None  # Coulomb friction over the bristles' stiffness

    @property
    def numbers(self) -> dict[str, float]:
        """Of a law with bristles by their names in a report; stiction and sigma_0 over Coulomb's torque."""
        assert self.bristle_travel is not None
        numbers = self.stiction_ratio, self.stribeck_speed, 1.0 / self.bristle_travel
        return dict(zip(("stiction", "stribeck_speed", "sigma_0"), numbers, strict=True))


@dataclass(frozen=True)
class Rig:
    """A rig file, checked. `constants` are known coefficients of the model's terms, by the term's name."""

    name: str
    path: Path
    columns: dict[str, Column]
    responses: tuple[Response, ...]
    stages: tuple[Stage, ...]
    estimate: tuple[str, ...] = ()
    constants: dict[str, float] = field(default_factory=dict)
    runs: dict[str, Any] = field(default_factory=dict)
    wall_time: dict[str, Any] = field(default_factory=dict)
    delimiter: str | None = None
    names: tuple[str, ...] = ()
    long: dict[str, str] = field(default_factory=dict)  # `name` and `value`: columns of a long table
    hold_out: float = DEFAULT_HOLD_OUT
    smooth_s: float | None = None
    analyse_period_s: float | None = None
    turn: float | None = None  # position units per turn
    sample_period_s: float | None = None
    controller: Controller | None = None
    supply_V: float | None = None  # what a duty of one gives
    format: str = "table"  # of its logs; axis-log and phd2 say their columns themselves
    motors: Motors | None = None
    friction: tuple[Friction, ...] = ()  # by state, the usual one first
    friction_law: FrictionLaw | None = None  # of a drive with one motor
    encoder_periods: int | None = None  # per turn of the position encoder

    @property
    def drifts(self) -> bool:
        """Whether what is explained is a position at constant rate, over time."""
        return self.format == "phd2" or any(r.channel == "position" for r in self.responses)
