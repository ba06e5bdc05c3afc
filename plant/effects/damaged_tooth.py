"""One tooth of a shaft is damaged: a pulse once per turn of that shaft, many harmonics."""

from math import exp, floor, pi

from plant.compiled import Floats
from plant.effects.base import ASSUMED, PHASE, SHAFTS, Effect, Parameter, Term
from plant.effects.signals import ANGLE, Hook


def formula(x: Floats, order: float, amplitude: float, phase: float, width: float) -> float:
    """Return the torque, N m at the axis: a Gaussian pulse in the angle of the shaft."""
    turn = (order * x[ANGLE] - phase) / (2.0 * pi)
    away = (turn - floor(turn + 0.5)) * 2.0 * pi / width
    return amplitude * exp(-0.5 * away * away)


EFFECT = Effect(
    name="damaged_tooth",
    catalogue_row=13,
    channel="T",
    domain="axis_angle",
    equation="T = A exp(-(shaft angle - phase)^2 / (2 width^2)), once per turn of the shaft",
    parameters=(
        Parameter("amplitude", "N m", -300.0, 300.0, 60.0, ASSUMED),
        PHASE,
        Parameter("width", "rad", 0.01, 1.0, 0.15, "ASSUMPTION: about one tooth of 21 to 27"),
    ),
    terms=(Term(Hook.AXIS_TORQUE, formula),),
    stages=SHAFTS,
)
