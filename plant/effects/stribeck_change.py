"""Static friction, Stribeck rate or exponent differ from the declared ones."""

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, Effect, Parameter, Term
from plant.effects.signals import MEMORY, STICTION, STRIBECK_EXPONENT, STRIBECK_RATE, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Scale Ts and the Stribeck rate, shift the exponent."""
    x[STICTION] *= p[MEMORY]
    x[STRIBECK_RATE] *= p[MEMORY + 1]
    x[STRIBECK_EXPONENT] += p[MEMORY + 2]
    return 0.0


EFFECT = Effect(
    name="stribeck_change",
    channel="T",
    domain="velocity",
    equation="Ts -> a Ts, ws -> b ws, delta -> delta + d",
    parameters=(
        Parameter("stiction_factor", "1", 0.3, 3.0, 1.3, ASSUMED),
        Parameter("velocity_factor", "1", 0.2, 5.0, 1.0, ASSUMED),
        Parameter("exponent_change", "1", -1.5, 2.0, 0.0, "hardware.md 1.1: delta 0.5 to 2"),
    ),
    source=CATALOGUE,
    terms=(Term(Hook.FRICTION, formula),),
    odd=True,
)
