"""The current reading is shifted."""

from plant.compiled import Floats, inner
from plant.effects.base import CATALOGUE, MOTOR_CHOICE, Effect, Parameter, Term
from plant.effects.signals import MEMORY, MOTOR, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the error of the reading, A."""
    if p[MEMORY + 1] != 0.0 and p[MEMORY + 1] != x[MOTOR] + 1.0:
        return 0.0
    return p[MEMORY]


EFFECT = Effect(
    name="adc_offset",
    channel="E",
    domain="current",
    equation="reading -> i + offset",
    parameters=(
        Parameter("offset", "A", -1.0, 1.0, 0.05, "ASSUMPTION: amplifier offset; 6.1 mA per count"),
        MOTOR_CHOICE,
    ),
    source=CATALOGUE,
    terms=(Term(Hook.CURRENT, formula),),
)
