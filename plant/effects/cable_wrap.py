"""The cable bundle: a spring over the axis angle with a hysteresis of its own."""

from math import exp

from plant.compiled import Floats
from plant.effects.base import ASSUMED, Effect, Parameter, Term
from plant.effects.signals import ANGLE, RATE, Hook


def formula(x: Floats, wrap: float, stiffness: float, centre: float, hysteresis: float) -> float:
    """Return the torque, N m at the axis."""
    return -stiffness * (x[ANGLE] - centre) - hysteresis * wrap


def update(x: Floats, dt: float, wrap: float, width: float) -> float:
    """Return the wrap, -1..1: Dahl hysteresis, exact for a constant rate."""
    goal = 1.0 if x[RATE] > 0.0 else -1.0
    return goal + (wrap - goal) * exp(-abs(x[RATE]) * dt / width)


EFFECT = Effect(
    name="cable_wrap",
    catalogue_row=32,
    channel="T",
    domain="axis_angle",
    equation="T = -k (angle - centre) - h z, dz/dangle = (1 - z sign w) / width",
    parameters=(
        Parameter("stiffness", "N m/rad", 0.0, 500.0, 30.0, ASSUMED),
        Parameter("centre", "rad", -7.0, 7.0, 0.0, "free: where the cable hangs straight"),
        Parameter("hysteresis", "N m", 0.0, 100.0, 8.0, ASSUMED),
        Parameter("width", "deg", 0.001, 30.0, 1.0, ASSUMED),
    ),
    terms=(Term(Hook.AXIS_TORQUE, formula, update, memory=("wrap",), lasting=True),),
)
