"""The magnets are weaker than declared: torque and back EMF fall together."""

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, MOTOR_CHOICE, Effect, Parameter, Term
from plant.effects.signals import MEMORY, MOTOR, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the relative change of the torque constant."""
    if p[MEMORY + 1] != 0.0 and p[MEMORY + 1] != x[MOTOR] + 1.0:
        return 0.0
    return -p[MEMORY]


EFFECT = Effect(
    name="magnet_weakening",
    channel="E",
    domain="velocity",
    equation="K -> K (1 - a)",
    parameters=(Parameter("loss", "1", -0.2, 0.6, 0.12, ASSUMED), MOTOR_CHOICE),
    source=CATALOGUE,
    terms=(Term(Hook.CONSTANT, formula),),
)
