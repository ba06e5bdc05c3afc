"""Coulomb friction differs from the declared one."""

from plant.compiled import Floats, inner
from plant.effects.base import CATALOGUE, Effect, Parameter, Term
from plant.effects.signals import COULOMB, MEMORY, STICTION, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Scale Tc; Ts never falls below it."""
    x[COULOMB] *= p[MEMORY]
    x[STICTION] = max(x[STICTION], x[COULOMB])
    return 0.0


EFFECT = Effect(
    name="coulomb_change",
    channel="T",
    domain="velocity",
    equation="Tc -> a Tc",
    parameters=(Parameter("factor", "1", 0.2, 3.0, 1.3, "hardware.md 2.3: +-20 % on Tc is fair"),),
    source=CATALOGUE,
    terms=(Term(Hook.FRICTION, formula),),
    odd=True,
)
