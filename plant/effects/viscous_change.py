"""Viscous friction differs from the declared one."""

from plant.compiled import Floats
from plant.effects.base import ASSUMED, Effect, Parameter, Term
from plant.effects.signals import SIGMA2, Hook


def formula(x: Floats, factor: float) -> None:
    """Scale sigma2."""
    x[SIGMA2] *= factor


EFFECT = Effect(
    name="viscous_change",
    catalogue_row=3,
    channel="T",
    domain="velocity",
    equation="sigma2 -> a sigma2",
    parameters=(Parameter("factor", "1", 0.2, 5.0, 1.3, ASSUMED),),
    terms=(Term(Hook.FRICTION, formula),),
    odd=True,
)
