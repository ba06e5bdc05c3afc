"""Wind on the tube: a mean and a broadband part."""

from math import exp, sqrt

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, Effect, Parameter, Term
from plant.effects.signals import MEMORY, Hook
from plant.kernels.noise import normal


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the torque, N m at the axis (p[0]: the broadband part in units of its own deviation)."""
    return p[MEMORY] + p[MEMORY + 1] * p[0]


@inner
def update(x: Floats, p: Floats, dt: float) -> None:
    """Ornstein-Uhlenbeck step; the noise depends on the seed (p[3]) and the count of steps (p[1]) only."""
    keep = exp(-dt / p[MEMORY + 2])
    p[0] = keep * p[0] + sqrt(1.0 - keep * keep) * normal(p[3], p[1])
    p[1] += 1.0


EFFECT = Effect(
    name="wind_torque",
    channel="T",
    domain="time",
    equation="T = mean + deviation n(t), n: Ornstein-Uhlenbeck, correlation time tau",
    parameters=(
        Parameter("mean", "N m", -200.0, 200.0, 10.0, ASSUMED),
        Parameter("deviation", "N m", 0.0, 200.0, 10.0, ASSUMED),
        Parameter("correlation_time", "s", 0.05, 100.0, 2.0, ASSUMED),
    ),
    source=CATALOGUE,
    terms=(Term(Hook.AXIS_TORQUE, formula, update),),
)
