"""Friction differs between the two directions."""

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, Effect, Parameter, Term
from plant.effects.signals import COULOMB, MEMORY, RATE, SIGMA2, STICTION, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Scale Tc, Ts and sigma2 up in one direction and down in the other."""
    side = 1.0 if x[RATE] > 0.0 else -1.0
    x[COULOMB] *= 1.0 + side * p[MEMORY]
    x[STICTION] *= 1.0 + side * p[MEMORY]
    x[SIGMA2] *= 1.0 + side * p[MEMORY + 1]
    return 0.0


EFFECT = Effect(
    name="friction_asymmetry",
    channel="T",
    domain="velocity",
    equation="Tc, Ts -> (1 + a sign w) Tc, Ts; sigma2 -> (1 + b sign w) sigma2",
    parameters=(
        Parameter("coulomb_asymmetry", "1", -0.6, 0.6, 0.15, ASSUMED),
        Parameter("viscous_asymmetry", "1", -0.6, 0.6, 0.0, ASSUMED),
    ),
    source=CATALOGUE,
    terms=(Term(Hook.FRICTION, formula),),
    odd=True,
)
