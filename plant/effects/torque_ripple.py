"""The torque constant varies with the motor angle (commutation)."""

from math import cos

from plant.compiled import Floats
from plant.effects.base import MOTOR_CHOICE, PHASE, Effect, Parameter, Term
from plant.effects.signals import MOTOR_ANGLE, Hook


def formula(x: Floats, cycles: float, ripple: float, phase: float) -> float:
    """Return the relative change of the torque constant."""
    return ripple * cos(cycles * x[MOTOR_ANGLE] + phase)


EFFECT = Effect(
    name="torque_ripple",
    catalogue_row=15,
    channel="T",
    domain="motor_angle",
    equation="K -> K (1 + r cos(N motor_angle + phase))",
    parameters=(
        Parameter("cycles", "1", 1.0, 200.0, 37.0, "hardware.md 1.2: 30 to 60 per turn, assumed"),
        Parameter("ripple", "1", 0.0, 0.4, 0.05, "hardware.md 1.2: 5 % (2 to 7 %), assumed"),
        PHASE,
        MOTOR_CHOICE,
    ),
    source="paper 4: commuting effects",
    terms=(Term(Hook.CONSTANT, formula),),
)
