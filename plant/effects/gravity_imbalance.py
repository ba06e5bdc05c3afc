"""The tube is not balanced about the axis."""

from math import cos

from plant.compiled import Floats, inner
from plant.effects.base import CATALOGUE, PHASE, Effect, Parameter, Term
from plant.effects.signals import ANGLE, MEMORY, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the torque, N m."""
    return p[MEMORY] * cos(x[ANGLE] - p[MEMORY + 1])


EFFECT = Effect(
    name="gravity_imbalance",
    channel="T",
    domain="axis_angle",
    equation="T = m g r cos(angle - phase)",
    parameters=(
        Parameter(
            "amplitude", "N m", 0.0, 400.0, 40.0, "ASSUMPTION: below the drive's 420 N m (paper Table 1)"
        ),
        PHASE,
    ),
    source="paper 4: imbalances; " + CATALOGUE,
    terms=(Term(Hook.AXIS_TORQUE, formula),),
)
