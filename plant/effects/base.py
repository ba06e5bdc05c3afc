"""What an effect is: a formula, its parameters with bounds, where it acts and where it is seen."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from plant.effects.signals import Hook

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
# (signals, parameters behind the effect's memory) -> value in the hook's unit
Formula = Callable[[Any, Any], float]
# (signals, parameters behind the effect's memory, step in s): advances the memory
Update = Callable[[Any, Any, float], None]


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
    """One compiled formula and the hook it acts at; `update` advances its memory once per step.

    `encoder`: at the encoder that the parameter `encoder` or the stage names; `target`: where the function
    says.
    """

    hook: Hook | Literal["encoder", "target"]
    formula: Formula
    update: Update | None = None


@dataclass(frozen=True)
class Effect:
    """One effect of the catalogue.

    channel: T torque residual, E electrical, K difference of encoders, S sensor, log or clock.
    stages: gear stages it may sit on (empty: it belongs to no stage); the order, in cycles per axis turn
    (stage order * harmonic), is then the formula's first parameter.
    constants: constants of the plant that follow the parameters in the formula's vector
    ("torque_constant" N m/A, "resistance" ohm, "ratio").
    odd: the torque changes its sign with the direction of motion.
    """

    name: str
    channel: Channel
    domain: Domain
    equation: str
    parameters: tuple[Parameter, ...]
    source: str
    terms: tuple[Term, ...]
    stages: tuple[str, ...] = ()
    constants: tuple[str, ...] = ()
    odd: bool = False

    @property
    def staged(self) -> bool:
        """Whether the effect belongs to a gear stage and has a harmonic."""
        return bool(self.stages)

    def parameter(self, name: str) -> Parameter:
        """Return the parameter called `name`; KeyError when there is none."""
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        raise KeyError(name)


SHAFTS = ("axis", "aux", "shaft2", "roller", "shaft1", "motor")
MESHES = ("mesh1", "mesh2", "mesh3")
STAGES = (*SHAFTS, *MESHES)
CATALOGUE = "effects.md, catalogue"
ASSUMED = "ASSUMPTION (effects.md [A])"
PHASE = Parameter("phase", "rad", -3.2, 3.2, 0.0, "free: unknown mounting angle")
MOTOR_CHOICE = Parameter("motor", "1", 0.0, 2.0, 0.0, "choice: 0 both motors, 1 A, 2 B")
ENCODER_CHOICE = Parameter("encoder", "1", 0.0, 2.0, 0.0, "choice: 0 incremental, 1 absolute, 2 auxiliary")
