"""The friction roller loses travel while the axis accelerates hard."""

from plant.compiled import Floats
from plant.effects.base import ASSUMED, Effect, Parameter, Term
from plant.effects.signals import ACCELERATION, RATE, Hook


def formula(x: Floats, lost: float) -> float:
    """Return the travel lost so far, rad at the axis."""
    return lost


def update(x: Floats, dt: float, lost: float, slip: float, threshold: float, creep: float) -> float:
    """Return the travel lost: above the threshold, a share of the rate and of the acceleration beyond it."""
    over = abs(x[ACCELERATION]) - threshold
    if over > 0.0:
        lost -= slip * x[RATE] * dt
        lost -= creep * (over if x[ACCELERATION] > 0.0 else -over) * dt
    return lost


EFFECT = Effect(
    name="roller_slip",
    catalogue_row=23,
    channel="K",
    domain="time",
    equation="d(incremental)/dt -> (1 - s) w - c sign(dw/dt) (|dw/dt| - limit) while |dw/dt| > limit",
    parameters=(
        Parameter("slip", "1", 0.0, 1.0, 0.02, ASSUMED),
        Parameter("threshold", "rad/s2", 0.0, 1.0, 0.005, ASSUMED),
        Parameter("creep", "s", 0.0, 1.0, 0.0, "ASSUMPTION: rate lost per acceleration beyond the threshold"),
    ),
    source="paper 2.2: friction roller",
    terms=(Term(Hook.INCREMENTAL, formula, update, memory=("lost",)),),
)
