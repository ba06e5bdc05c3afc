"""Friction differs between the two directions."""

from plant.compiled import Floats
from plant.effects.base import ASSUMED, Effect, Parameter, Term
from plant.effects.signals import COULOMB, RATE, SIGMA2, STICTION, Hook


def formula(x: Floats, coulomb_asymmetry: float, viscous_asymmetry: float) -> None:
    """Scale Tc, Ts and sigma2 up in one direction and down in the other."""
    side = 1.0 if x[RATE] > 0.0 else -1.0
    x[COULOMB] *= 1.0 + side * coulomb_asymmetry
    x[STICTION] *= 1.0 + side * coulomb_asymmetry
    x[SIGMA2] *= 1.0 + side * viscous_asymmetry


EFFECT = Effect(
    name="friction_asymmetry",
    catalogue_row=5,
    channel="T",
    domain="velocity",
    equation="Tc, Ts -> (1 + a sign w) Tc, Ts; sigma2 -> (1 + b sign w) sigma2",
    parameters=(
        Parameter("coulomb_asymmetry", "1", -0.6, 0.6, 0.15, ASSUMED),
        Parameter("viscous_asymmetry", "1", -0.6, 0.6, 0.0, ASSUMED),
    ),
    terms=(Term(Hook.FRICTION, formula),),
    odd=True,
)
