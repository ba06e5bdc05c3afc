"""The supply gives way under load."""

from plant.compiled import Floats, inner
from plant.effects.base import CATALOGUE, Effect, Parameter, Term
from plant.effects.signals import MEMORY, SUPPLY_CURRENT, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the change of the supply, V."""
    return -p[MEMORY] * x[SUPPLY_CURRENT]


EFFECT = Effect(
    name="supply_sag",
    channel="E",
    domain="current",
    equation="V = V0 - Rs sum(duty i)",
    parameters=(Parameter("resistance", "ohm", 0.0, 1.0, 0.15, "ASSUMPTION: supply and cable"),),
    source=CATALOGUE,
    terms=(Term(Hook.SUPPLY, formula),),
)
