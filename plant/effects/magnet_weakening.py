"""The magnets are weaker than declared: torque and back EMF fall together."""

from plant.compiled import Floats
from plant.effects.base import ASSUMED, MOTOR_CHOICE, Effect, Parameter, Term
from plant.effects.signals import Hook


def formula(x: Floats, loss: float) -> float:
    """Return the relative change of the torque constant."""
    return -loss


EFFECT = Effect(
    name="magnet_weakening",
    catalogue_row=30,
    channel="E",
    domain="velocity",
    equation="K -> K (1 - a)",
    parameters=(Parameter("loss", "1", -0.2, 0.6, 0.12, ASSUMED), MOTOR_CHOICE),
    terms=(Term(Hook.CONSTANT, formula),),
)
