"""Coulomb friction differs from the declared one."""

from plant.compiled import Floats
from plant.effects.base import Effect, Parameter, Term
from plant.effects.signals import COULOMB, STICTION, Hook


def formula(x: Floats, factor: float) -> None:
    """Scale Tc; Ts never falls below it."""
    x[COULOMB] *= factor
    x[STICTION] = max(x[STICTION], x[COULOMB])


EFFECT = Effect(
    name="coulomb_change",
    catalogue_row=4,
    channel="T",
    domain="velocity",
    equation="Tc -> a Tc",
    parameters=(Parameter("factor", "1", 0.2, 3.0, 1.3, "hardware.md 2.3: +-20 % on Tc is fair"),),
    terms=(Term(Hook.FRICTION, formula),),
    odd=True,
)
