"""Torque at the tooth meshing order of one stage."""

from math import sin

from plant.compiled import Floats
from plant.effects.base import ASSUMED, MESHES, PHASE, Effect, Parameter, Term
from plant.effects.signals import ANGLE, Hook


def formula(x: Floats, order: float, amplitude: float, phase: float) -> float:
    """Return the torque, N m at the axis."""
    return amplitude * sin(order * x[ANGLE] + phase)


EFFECT = Effect(
    name="gear_mesh",
    catalogue_row=12,
    channel="T",
    domain="axis_angle",
    equation="T = A sin(order angle + phase)",
    parameters=(Parameter("amplitude", "N m", 0.0, 100.0, 8.0, ASSUMED), PHASE),
    terms=(Term(Hook.AXIS_TORQUE, formula),),
    stages=MESHES,
)
