"""The tube is not balanced about the axis."""

from math import cos

from plant.compiled import Floats
from plant.effects.base import PHASE, Effect, Parameter, Term
from plant.effects.signals import ANGLE, Hook


def formula(x: Floats, amplitude: float, phase: float) -> float:
    """Return the torque, N m."""
    return amplitude * cos(x[ANGLE] - phase)


EFFECT = Effect(
    name="gravity_imbalance",
    catalogue_row=10,
    channel="T",
    domain="axis_angle",
    equation="T = m g r cos(angle - phase)",
    parameters=(
        Parameter(
            "amplitude", "N m", 0.0, 400.0, 40.0, "ASSUMPTION: below the drive's 420 N m (paper Table 1)"
        ),
        PHASE,
    ),
    source="paper 4: imbalances",
    terms=(Term(Hook.AXIS_TORQUE, formula),),
)
