"""The friction roller is not 735:30: the incremental encoder has another scale."""

from plant.compiled import Floats
from plant.effects.base import ASSUMED, Effect, Parameter, Term
from plant.effects.signals import ANGLE, Hook


def formula(x: Floats, error: float) -> float:
    """Return the error of the incremental reading, rad at the axis."""
    return error * x[ANGLE]


EFFECT = Effect(
    name="roller_ratio",
    catalogue_row=22,
    channel="K",
    domain="axis_angle",
    equation="incremental -> (1 + e) angle",
    parameters=(Parameter("error", "ppm", -20000.0, 20000.0, 500.0, ASSUMED),),
    source="paper 2.2: friction roller",
    terms=(Term(Hook.INCREMENTAL, formula),),
)
