"""The friction roller loses travel while the axis accelerates hard."""

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, Effect, Parameter, Term
from plant.effects.signals import ACCELERATION, MEMORY, RATE, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the travel lost so far, rad at the axis (p[0])."""
    return p[0]


@inner
def update(x: Floats, p: Floats, dt: float) -> None:
    """Lose a share of the rate, or a rate that grows with the acceleration, above the threshold."""
    if abs(x[ACCELERATION]) > p[MEMORY + 1]:
        p[0] -= p[MEMORY] * x[RATE] * dt
        over = abs(x[ACCELERATION]) - p[MEMORY + 1]
        p[0] -= p[MEMORY + 2] * (over if x[ACCELERATION] > 0.0 else -over) * dt


EFFECT = Effect(
    name="roller_slip",
    channel="K",
    domain="time",
    equation="d(incremental)/dt -> (1 - s) w - c sign(dw/dt) (|dw/dt| - limit) while |dw/dt| > limit",
    parameters=(
        Parameter("slip", "1", 0.0, 1.0, 0.02, ASSUMED),
        Parameter("threshold", "rad/s2", 0.0, 1.0, 0.005, ASSUMED),
        Parameter("creep", "s", 0.0, 1.0, 0.0, "ASSUMPTION: rate lost per acceleration beyond the threshold"),
    ),
    source="paper 2.2: friction roller; " + CATALOGUE,
    terms=(Term(Hook.INCREMENTAL, formula, update),),
)
