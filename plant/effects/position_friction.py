"""Friction depends on the angle: odd in direction, where cogging and imbalance are even."""

from math import cos

from plant.compiled import Floats
from plant.effects.base import ASSUMED, PHASE, STAGES, Effect, Parameter, Term
from plant.effects.signals import ANGLE, COULOMB, STICTION, Hook


def formula(x: Floats, order: float, amplitude: float, phase: float) -> None:
    """Add a wave over the angle to Tc and Ts."""
    change = amplitude * cos(order * x[ANGLE] - phase)
    x[COULOMB] = max(0.0, x[COULOMB] + change)
    x[STICTION] = max(x[COULOMB], x[STICTION] + change)


EFFECT = Effect(
    name="position_friction",
    catalogue_row=6,
    channel="T",
    domain="axis_angle",
    equation="Tc, Ts -> Tc, Ts + c cos(order angle - phase)",
    parameters=(Parameter("amplitude", "N m", 0.0, 300.0, 30.0, ASSUMED), PHASE),
    stages=STAGES,
    terms=(Term(Hook.FRICTION, formula),),
    odd=True,
)
