"""A line at an order that belongs to no shaft: rolling elements of a bearing."""

from math import sin

from plant.compiled import Floats
from plant.effects.base import ASSUMED, PHASE, Effect, Parameter, Term
from plant.effects.signals import ANGLE, Hook


def formula(x: Floats, order: float, amplitude: float, phase: float) -> float:
    """Return the torque, N m at the axis."""
    return amplitude * sin(order * x[ANGLE] + phase)


EFFECT = Effect(
    name="bearing_pass",
    catalogue_row=34,
    channel="T",
    domain="axis_angle",
    equation="T = A sin(order angle + phase)",
    parameters=(
        Parameter("order", "1", 2.0, 20000.0, 437.3, "ASSUMPTION: no shaft of the gear table"),
        Parameter("amplitude", "N m", 0.0, 200.0, 10.0, ASSUMED),
        PHASE,
    ),
    terms=(Term(Hook.AXIS_TORQUE, formula),),
)
