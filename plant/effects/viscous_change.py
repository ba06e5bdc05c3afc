"""Viscous friction differs from the declared one."""

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, Effect, Parameter, Term
from plant.effects.signals import MEMORY, SIGMA2, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Scale sigma2."""
    x[SIGMA2] *= p[MEMORY]
    return 0.0


EFFECT = Effect(
    name="viscous_change",
    channel="T",
    domain="velocity",
    equation="sigma2 -> a sigma2",
    parameters=(Parameter("factor", "1", 0.2, 5.0, 1.3, ASSUMED),),
    source=CATALOGUE,
    terms=(Term(Hook.FRICTION, formula),),
    odd=True,
)
