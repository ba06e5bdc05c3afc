"""Friction changes while the axis warms up in motion; rest cools it again."""

from math import exp

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, Effect, Parameter, Term
from plant.effects.signals import COULOMB, MEMORY, RATE, SIGMA2, STICTION, Hook

MOVING = 1e-6  # rad/s, 0.2 arcsec/s: below it the axis rests


@inner
def formula(x: Floats, p: Floats) -> float:
    """Scale Tc, Ts and sigma2 by 1 - a exp(-t / tau), t being time in motion."""
    factor = 1.0 - p[MEMORY] * (1.0 - p[0])
    x[COULOMB] *= factor
    x[STICTION] *= factor
    x[SIGMA2] *= factor
    return 0.0


@inner
def update(x: Floats, p: Floats, dt: float) -> None:
    """Warm towards 1 in motion and towards 0 at rest (p[0]: warmth)."""
    goal = 1.0 if abs(x[RATE]) > MOVING else 0.0
    p[0] += (goal - p[0]) * (1.0 - exp(-dt / p[MEMORY + 1]))


EFFECT = Effect(
    name="friction_warmup",
    channel="T",
    domain="time",
    equation="F -> F (1 - a exp(-t / tau)); a < 0: friction decays after the start",
    parameters=(
        Parameter("depth", "1", -2.0, 0.9, -0.3, ASSUMED),
        Parameter("time_constant", "s", 5.0, 3600.0, 120.0, ASSUMED),
    ),
    source=CATALOGUE,
    terms=(Term(Hook.FRICTION, formula, update),),
    odd=True,
)
