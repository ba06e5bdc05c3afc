"""The driver swallows the first part of each pulse."""

from plant.compiled import Floats
from plant.effects.base import Effect, Parameter, Term
from plant.effects.signals import COMMAND, Hook


def formula(x: Floats, deadband: float) -> float:
    """Return the change of the duty."""
    return -min(x[COMMAND], deadband)


EFFECT = Effect(
    name="pwm_deadband",
    catalogue_row=26,
    channel="E",
    domain="command",
    equation="duty -> max(0, duty - u0)",
    parameters=(
        Parameter("deadband", "1", 0.0, 0.2, 0.01, "ASSUMPTION: gate delay of the IRF250 driver stage"),
    ),
    terms=(Term(Hook.COMMAND, formula),),
)
