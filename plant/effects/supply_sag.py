"""The supply gives way under load."""

from plant.compiled import Floats
from plant.effects.base import Effect, Parameter, Term
from plant.effects.signals import SUPPLY_CURRENT, Hook


def formula(x: Floats, resistance: float) -> float:
    """Return the change of the supply, V."""
    return -resistance * x[SUPPLY_CURRENT]


EFFECT = Effect(
    name="supply_sag",
    catalogue_row=28,
    channel="E",
    domain="current",
    equation="V = V0 - Rs sum(duty i)",
    parameters=(Parameter("resistance", "ohm", 0.0, 1.0, 0.15, "ASSUMPTION: supply and cable"),),
    terms=(Term(Hook.SUPPLY, formula),),
)
