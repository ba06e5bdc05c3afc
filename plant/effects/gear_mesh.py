"""Torque at the tooth meshing order of one stage."""

from math import sin

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, MESHES, PHASE, Effect, Parameter, Term
from plant.effects.signals import ANGLE, MEMORY, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the torque, N m at the axis."""
    return p[MEMORY + 1] * sin(p[MEMORY] * x[ANGLE] + p[MEMORY + 2])


EFFECT = Effect(
    name="gear_mesh",
    channel="T",
    domain="axis_angle",
    equation="T = A sin(order angle + phase)",
    parameters=(Parameter("amplitude", "N m", 0.0, 100.0, 8.0, ASSUMED), PHASE),
    source=CATALOGUE,
    terms=(Term(Hook.AXIS_TORQUE, formula),),
    stages=MESHES,
)
