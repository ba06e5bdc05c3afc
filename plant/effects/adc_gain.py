"""The current reading has another gain."""

from plant.compiled import Floats
from plant.effects.base import MOTOR_CHOICE, Effect, Parameter, Term
from plant.effects.signals import CURRENT, Hook


def formula(x: Floats, gain: float) -> float:
    """Return the error of the reading, A."""
    return (gain - 1.0) * x[CURRENT]


EFFECT = Effect(
    name="adc_gain",
    catalogue_row=25,
    channel="E",
    domain="current",
    equation="reading -> gain i",
    parameters=(
        Parameter("gain", "1", 0.5, 1.5, 1.08, "ASSUMPTION: sense resistor and amplifier tolerance"),
        MOTOR_CHOICE,
    ),
    terms=(Term(Hook.CURRENT, formula),),
)
