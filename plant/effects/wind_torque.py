"""Wind on the tube: a mean and a broadband part."""

from math import exp, sqrt

from plant.compiled import Floats
from plant.effects.base import ASSUMED, CATALOGUE, Effect, Parameter, Term
from plant.effects.signals import Hook
from plant.kernels.noise import normal


def formula(x: Floats, gust: float, mean: float, deviation: float) -> float:
    """Return the torque, N m at the axis."""
    return mean + deviation * gust


def update(
    x: Floats, dt: float, gust: float, steps: float, seed: float, correlation_time: float
) -> tuple[float, float]:
    """Ornstein-Uhlenbeck step of the gust, in deviations; its noise is that of seed and count of steps."""
    keep = exp(-dt / correlation_time)
    gust = keep * gust + sqrt(1.0 - keep * keep) * normal(seed, steps)
    return gust, steps + 1.0


EFFECT = Effect(
    name="wind_torque",
    catalogue_row=31,
    channel="T",
    domain="time",
    equation="T = mean + deviation n(t), n: Ornstein-Uhlenbeck, correlation time tau",
    parameters=(
        Parameter("mean", "N m", -200.0, 200.0, 10.0, ASSUMED),
        Parameter("deviation", "N m", 0.0, 200.0, 10.0, ASSUMED),
        Parameter("correlation_time", "s", 0.05, 100.0, 2.0, ASSUMED),
    ),
    source=CATALOGUE,
    terms=(Term(Hook.AXIS_TORQUE, formula, update, memory=("gust", "steps")),),
)
