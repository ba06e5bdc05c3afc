"""Detent torque of a motor: a wave in its angle, whatever the current."""

from math import sin

from plant.compiled import Floats
from plant.effects.base import ASSUMED, MOTOR_CHOICE, PHASE, Effect, Parameter, Term
from plant.effects.signals import MOTOR_ANGLE, Hook


def formula(x: Floats, cycles: float, amplitude: float, phase: float) -> float:
    """Return the torque, N m at the motor."""
    return amplitude * sin(cycles * x[MOTOR_ANGLE] + phase)


EFFECT = Effect(
    name="motor_cogging",
    catalogue_row=14,
    channel="T",
    domain="motor_angle",
    equation="T_motor = A sin(N motor_angle + phase)",
    parameters=(
        Parameter("cycles", "1", 1.0, 200.0, 37.0, "ASSUMPTION: slots of the armature; hardware.md 1.2"),
        Parameter("amplitude", "N m", 0.0, 0.5, 0.03, ASSUMED),
        PHASE,
        MOTOR_CHOICE,
    ),
    terms=(Term(Hook.MOTOR_TORQUE, formula),),
)
