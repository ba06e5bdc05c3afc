"""The current reading has another gain."""

from plant.compiled import Floats, inner
from plant.effects.base import CATALOGUE, MOTOR_CHOICE, Effect, Parameter, Term
from plant.effects.signals import CURRENT, MEMORY, MOTOR, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the error of the reading, A."""
    if p[MEMORY + 1] != 0.0 and p[MEMORY + 1] != x[MOTOR] + 1.0:
        return 0.0
    return (p[MEMORY] - 1.0) * x[CURRENT]


EFFECT = Effect(
    name="adc_gain",
    channel="E",
    domain="current",
    equation="reading -> gain i",
    parameters=(
        Parameter("gain", "1", 0.5, 1.5, 1.08, "ASSUMPTION: sense resistor and amplifier tolerance"),
        MOTOR_CHOICE,
    ),
    source=CATALOGUE,
    terms=(Term(Hook.CURRENT, formula),),
)
