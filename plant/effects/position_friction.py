"""Friction depends on the angle: odd in direction, where cogging and imbalance are even."""

from math import cos

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, PHASE, STAGES, Effect, Parameter, Term
from plant.effects.signals import ANGLE, COULOMB, MEMORY, STICTION, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Add a wave over the angle to Tc and Ts."""
    change = p[MEMORY + 1] * cos(p[MEMORY] * x[ANGLE] - p[MEMORY + 2])
    x[COULOMB] = max(0.0, x[COULOMB] + change)
    x[STICTION] = max(x[COULOMB], x[STICTION] + change)
    return 0.0


EFFECT = Effect(
    name="position_friction",
    channel="T",
    domain="axis_angle",
    equation="Tc, Ts -> Tc, Ts + c cos(order angle - phase)",
    parameters=(Parameter("amplitude", "N m", 0.0, 300.0, 30.0, ASSUMED), PHASE),
    source=CATALOGUE,
    stages=STAGES,
    terms=(Term(Hook.FRICTION, formula),),
    odd=True,
)
