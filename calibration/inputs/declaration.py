"""A drive as its rig file declares it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

#: what a response stands for: a balance of forces, or one sensor against another
FORCES = ("effort", "force", "current", "acceleration")
SENSORS = ("position2", "position")
#: terms of the declared model of a force
TERMS = ("inertia", "viscous", "coulomb", "offset", "drift", "stiffness", "gravity")


@dataclass(frozen=True)
class Column:
    """Where a channel is in the file, its unit, and the factor to the rig's unit."""

    column: str | int
    unit: str
    scale: float = 1.0
    offset: float = 0.0  # rig units, added after the scale
    wrap: float | None = None  # length of the counter, file units
    delay_s: float = 0.0  # known lateness, taken out
    window_s: float | None = None  # over which a counted rate counts, up to the row's stamp


@dataclass(frozen=True)
class Stage:
    """A rotating part: its period in position units; `period_s` for a drive at constant rate."""

    name: str
    period: float | None
    period_s: float | None
    harmonics: int
    kind: str | None


@dataclass(frozen=True)
class Response:
    """What a balance explains: `gain` times a column, in `unit`; over another column where `divide_by` is
    given."""

    channel: str
    unit: str
    gain: float = 1.0
    divide_by: str | None = None
    ratio: float | None = None  # of a second sensor to the first; None: estimated

    @property
    def is_force(self) -> bool:
        """True for a balance of forces, False for one sensor against another."""
        return self.channel in FORCES


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

    state: str
    coulomb: float
    stiction: float
    stribeck_rate: float
    stribeck_exponent: float
    viscous: float
    bristle_stiffness: float


@dataclass(frozen=True)
class FrictionLaw:
    """Shape of the friction of a drive with one motor, whose size is the term `coulomb`: a dip from rest
    (Stribeck), bristles (LuGre), or both. Position units and s."""

    stiction_ratio: float = 1.0  # friction from rest over Coulomb's
    stribeck_speed: float = 1.0
    stribeck_exponent: float = 2.0
    bristle_travel: float | None = None  # Coulomb friction over the bristles' stiffness


@dataclass(frozen=True)
class Rig:
    """A rig file, checked. `constants` are known coefficients of the model's terms, by the term's name."""

    name: str
    path: Path
    columns: dict[str, Column]
    responses: tuple[Response, ...]
    estimate: tuple[str, ...]
    stages: tuple[Stage, ...]
    constants: dict[str, float]
    runs: dict[str, Any]
    wall_time: dict[str, Any]
    delimiter: str | None
    names: tuple[str, ...]
    hold_out: float
    smooth_s: float | None
    analyse_period_s: float | None
    turn: float | None  # position units per turn
    sample_period_s: float | None
    controller: Controller | None = None
    supply_V: float | None = None  # what a duty of one gives
    format: str = "table"  # of its logs; axis-log and phd2 say their columns themselves
    motors: Motors | None = None
    friction: tuple[Friction, ...] = ()  # by state, the usual one first
    friction_law: FrictionLaw | None = None  # of a drive with one motor
    encoder_periods: int | None = None  # per turn of the position encoder
    raw: dict[str, Any] = field(default_factory=dict)

    @property
    def drifts(self) -> bool:
        """Whether what is explained is a position at constant rate, over time."""
        return self.format == "phd2" or any(r.channel == "position" for r in self.responses)
