"""Friction changes while the axis warms up in motion; rest cools it again."""

from math import exp

from plant.compiled import Floats
from plant.effects.base import ASSUMED, Effect, Parameter, Term
from plant.effects.signals import COULOMB, RATE, SIGMA2, STICTION, Hook

MOVING = 1e-6  # rad/s, 0.2 arcsec/s: below it the axis rests


def formula(x: Floats, warmth: float, depth: float) -> None:
    """Scale Tc, Ts and sigma2 by 1 - a exp(-t / tau), t being time in motion."""
    factor = 1.0 - depth * (1.0 - warmth)
    x[COULOMB] *= factor
    x[STICTION] *= factor
    x[SIGMA2] *= factor


def update(x: Floats, dt: float, warmth: float, time_constant: float) -> float:
    """Return the warmth, 0..1: towards 1 in motion and towards 0 at rest."""
    goal = 1.0 if abs(x[RATE]) > MOVING else 0.0
    return warmth + (goal - warmth) * (1.0 - exp(-dt / time_constant))


EFFECT = Effect(
    name="friction_warmup",
    catalogue_row=8,
    channel="T",
    domain="time",
    equation="F -> F (1 - a exp(-t / tau)); a < 0: friction decays after the start",
    parameters=(
        Parameter("depth", "1", -2.0, 0.9, -0.3, ASSUMED),
        Parameter("time_constant", "s", 5.0, 3600.0, 120.0, ASSUMED),
    ),
    terms=(Term(Hook.FRICTION, formula, update, memory=("warmth",)),),
    odd=True,
)
