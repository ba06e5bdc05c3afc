"""The winding warms with its loss and its resistance grows."""

from math import exp

from plant.compiled import Floats
from plant.effects.base import ASSUMED, Effect, Parameter, Term
from plant.effects.signals import CURRENT, Hook

COPPER = 0.00393  # 1/K, temperature coefficient of copper at 20 degC


def formula(x: Floats, warmth: float, winding: float) -> float:
    """Return the change of the winding resistance of the motor concerned, ohm."""
    return winding * COPPER * warmth


def update(
    x: Floats, dt: float, warmth: float, thermal_resistance: float, time_constant: float, winding: float
) -> float:
    """Return the warmth of the motor concerned, K: first-order heating by i^2 R."""
    goal = thermal_resistance * x[CURRENT] * x[CURRENT] * winding
    return warmth + (goal - warmth) * (1.0 - exp(-dt / time_constant))


EFFECT = Effect(
    name="winding_heating",
    catalogue_row=29,
    channel="E",
    domain="time",
    equation="R -> R (1 + alpha dT), tau d(dT)/dt = Rth i^2 R - dT",
    parameters=(
        Parameter("thermal_resistance", "K/W", 0.0, 10.0, 1.5, ASSUMED),
        Parameter("time_constant", "s", 10.0, 7200.0, 600.0, ASSUMED),
    ),
    terms=(Term(Hook.RESISTANCE, formula, update, memory=("warmth",), lasting=True),),
    constants=("winding",),
)
