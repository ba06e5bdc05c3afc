"""The current reading is shifted."""

from plant.compiled import Floats
from plant.effects.base import MOTOR_CHOICE, Effect, Parameter, Term
from plant.effects.signals import Hook


def formula(x: Floats, offset: float) -> float:
    """Return the error of the reading, A."""
    return offset


EFFECT = Effect(
    name="adc_offset",
    catalogue_row=24,
    channel="E",
    domain="current",
    equation="reading -> i + offset",
    parameters=(
        Parameter("offset", "A", -1.0, 1.0, 0.05, "ASSUMPTION: amplifier offset; 6.1 mA per count"),
        MOTOR_CHOICE,
    ),
    terms=(Term(Hook.CURRENT, formula),),
)
