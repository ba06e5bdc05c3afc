"""What an effect is: a formula, its parameters with bounds, where it acts and where it is seen."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from inspect import signature
from typing import Literal

from plant.effects.signals import MEMORY, MOTOR, MOTOR_HOOKS, SEED, Hook

Channel = Literal["T", "E", "K", "S"]
Domain = Literal[
    "axis_angle",
    "motor_angle",
    "time",
    "velocity",
    "reversal",
    "current",
    "command",
    "temperature",
    "clock",
]
# share of freewheel braking; its drop, V; wind-up of the trains, rad/(N m); inertia taken off the axis, kg m2
Switch = Literal["diode", "diode_drop", "compliance", "swinging"]
# (x, what it needs by name) -> value in the hook's unit; None: it changes the friction parameters in x
Formula = Callable[..., float | None]
# (x, dt in s, what it needs by name) -> the term's memory, one step on
Update = Callable[..., float | tuple[float, ...] | None]


@dataclass(frozen=True)
class Parameter:
    """One number of an effect: unit, bounds and default in that unit, and where they come from."""

    name: str
    unit: str
    low: float
    high: float
    default: float
    source: str


@dataclass(frozen=True)
class Term:
    """One formula and the hook it acts at; `update` advances its memory once per step.

    Both take the signals x (plant/effects/signals.py), `update` the step dt, s. Then they take by name what
    they need, in this order: memory, `order` of a staged effect, parameters, constants; SI units. `seed` is a
    whole number of the effect's own, for noise. They are compiled: numbers in, numbers out.
    hook: `encoder`: at the encoder that the parameter `encoder` or the stage names; `target`: where the
    function says. A parameter `motor` chooses the motor: at the other one the value is 0.
    formula: None at the hook LOG, which is no part of the step.
    memory: names of the numbers, zero at the start, that `update` returns; each motor has its own.
    moving: those of them that are the rate of something that moves along with the axis.
    lasting: a log begins with the memory of the motion before it, not with zero.
    """

    hook: Hook | Literal["encoder", "target"]
    formula: Formula | None = None
    update: Update | None = None
    memory: tuple[str, ...] = ()
    moving: tuple[str, ...] = ()
    lasting: bool = False

    @property
    def of_motors(self) -> bool:
        """Whether it acts on each motor."""
        return isinstance(self.hook, Hook) and self.hook < MOTOR_HOOKS


OUTSIDE = 1000
"""In the place of a row: behind all that docs/sources/effects.md has."""


@dataclass(frozen=True)
class Effect:
    """One effect of the catalogue.

    channel: T torque residual, E electrical, K difference of encoders, S sensor, log or clock.
    stages: gear stages it may sit on (empty: it belongs to no stage). Formulas then know the order, in cycles
    per axis turn (stage order * harmonic).
    constants: constants of the plant that formulas know beside the parameters
    ("torque_constant" N m/A, "resistance" ohm, "winding" ohm, "ratio").
    Raises TypeError for a formula whose arguments are not what the declaration names.
    switches: parameters that change a constant of the axis once (plant/world.py), and which.
    catalogue_row: its place in lists; those outside the catalogue follow by name.
    odd: the torque changes its sign with the direction of motion.
    source: what describes it, beside the catalogue where it has a row there. Raises TypeError without either.
    """

    name: str
    channel: Channel
    domain: Domain
    equation: str
    parameters: tuple[Parameter, ...]
    terms: tuple[Term, ...]
    source: str = ""
    stages: tuple[str, ...] = ()
    constants: tuple[str, ...] = ()
    switches: Mapping[str, Switch] = field(default_factory=dict)
    odd: bool = False
    catalogue_row: int = OUTSIDE

    def __post_init__(self) -> None:
        if not self.source and self.catalogue_row == OUTSIDE:
            raise TypeError(f"effect {self.name}: it has neither a source nor a row of the catalogue")
        for term in self.terms:
            for function, first in ((term.formula, ["x"]), (term.update, ["x", "dt"])):
                given = first if function is None else list(signature(function).parameters)
                known = [*first, *self.places(term)]
                if given != [word for word in known if word in given or word in first]:
                    raise TypeError(
                        f"effect {self.name}: {getattr(function, '__name__', '')}({', '.join(given)}): "
                        f"arguments are, in this order, of ({', '.join(known)})"
                    )

    @property
    def numbers(self) -> tuple[str, ...]:
        """Names of the numbers that an effect in a plant file gives its formulas, in the order of its row."""
        order = ("order",) if self.staged else ()
        return (*order, *(parameter.name for parameter in self.parameters), *self.constants)

    def places(self, term: Term) -> dict[str, str]:
        """Return what formulas of `term` may name, and where it lies in the signals x or the row p."""
        if not self.numbers:
            return {"p": "p"}  # `unknown`: a row of its own kind
        motor = f"2 * {{}} + int(x[{MOTOR}])" if term.of_motors else "{}"
        memory = {word: f"p[{motor.format(k)}]" for k, word in enumerate(term.memory)}
        numbers = {word: f"p[{MEMORY + k}]" for k, word in enumerate(self.numbers)}
        return {**memory, "seed": f"p[{SEED}]", **numbers}

    @property
    def staged(self) -> bool:
        """Whether the effect belongs to a gear stage and has a harmonic."""
        return bool(self.stages)

    @property
    def wave(self) -> bool:
        """Whether it is a torque that is one sine of the axis' angle or a motor's."""
        names = {p.name for p in self.parameters}
        of_angle = self.channel == "T" and self.domain in ("axis_angle", "motor_angle")
        return of_angle and "phase" in names and "width" not in names

    def parameter(self, name: str) -> Parameter:
        """Return the parameter called `name`; KeyError when there is none."""
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        raise KeyError(name)


SHAFTS = ("axis", "aux", "shaft2", "roller", "shaft1", "motor")
MESHES = ("mesh1", "mesh2", "mesh3")
STAGES = (*SHAFTS, *MESHES)
ASSUMED = "ASSUMPTION, docs/sources/effects.md"
PHASE = Parameter("phase", "rad", -3.2, 3.2, 0.0, "free: unknown mounting angle")
MOTOR_CHOICE = Parameter("motor", "1", 0.0, 2.0, 0.0, "choice: 0 both motors, 1 A, 2 B")
