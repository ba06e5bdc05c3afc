"""The winding warms with its loss and its resistance grows."""

from math import exp

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, Effect, Parameter, Term
from plant.effects.signals import CURRENT, MEMORY, MOTOR, Hook

COPPER = 0.00393  # 1/K, temperature coefficient of copper at 20 degC


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the change of the winding resistance of the motor concerned, ohm (p[0], p[1]: warmth, K)."""
    return p[MEMORY + 2] * COPPER * p[int(x[MOTOR])]


@inner
def update(x: Floats, p: Floats, dt: float) -> None:
    """First-order heating by i^2 R; called once per motor."""
    m = int(x[MOTOR])
    goal = p[MEMORY] * x[CURRENT] * x[CURRENT] * p[MEMORY + 2]
    p[m] += (goal - p[m]) * (1.0 - exp(-dt / p[MEMORY + 1]))


EFFECT = Effect(
    name="winding_heating",
    channel="E",
    domain="time",
    equation="R -> R (1 + alpha dT), tau d(dT)/dt = Rth i^2 R - dT",
    parameters=(
        Parameter("thermal_resistance", "K/W", 0.0, 10.0, 1.5, ASSUMED),
        Parameter("time_constant", "s", 10.0, 7200.0, 600.0, ASSUMED),
    ),
    source=CATALOGUE,
    terms=(Term(Hook.RESISTANCE, formula, update),),
    constants=("winding",),
)
