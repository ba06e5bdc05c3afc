"""The cable bundle: a spring over the axis angle with a hysteresis of its own."""

from math import exp

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, Effect, Parameter, Term
from plant.effects.signals import ANGLE, MEMORY, RATE, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the torque, N m at the axis (p[0]: the hysteresis, -1..1)."""
    return -p[MEMORY] * (x[ANGLE] - p[MEMORY + 1]) - p[MEMORY + 2] * p[0]


@inner
def update(x: Floats, p: Floats, dt: float) -> None:
    """Dahl hysteresis, exact for a constant rate."""
    goal = 1.0 if x[RATE] > 0.0 else -1.0
    p[0] = goal + (p[0] - goal) * exp(-abs(x[RATE]) * dt / p[MEMORY + 3])


EFFECT = Effect(
    name="cable_wrap",
    channel="T",
    domain="axis_angle",
    equation="T = -k (angle - centre) - h z, dz/dangle = (1 - z sign w) / width",
    parameters=(
        Parameter("stiffness", "N m/rad", 0.0, 500.0, 30.0, ASSUMED),
        Parameter("centre", "rad", -7.0, 7.0, 0.0, "free: where the cable hangs straight"),
        Parameter("hysteresis", "N m", 0.0, 100.0, 8.0, ASSUMED),
        Parameter("width", "deg", 0.001, 30.0, 1.0, ASSUMED),
    ),
    source=CATALOGUE,
    terms=(Term(Hook.AXIS_TORQUE, formula, update),),
)
