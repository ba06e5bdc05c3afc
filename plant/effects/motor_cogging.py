"""Detent torque of a motor: a wave in its angle, whatever the current."""

from math import sin

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, MOTOR_CHOICE, PHASE, Effect, Parameter, Term
from plant.effects.signals import MEMORY, MOTOR, MOTOR_ANGLE, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the torque, N m at the motor."""
    if p[MEMORY + 3] != 0.0 and p[MEMORY + 3] != x[MOTOR] + 1.0:
        return 0.0
    return p[MEMORY + 1] * sin(p[MEMORY] * x[MOTOR_ANGLE] + p[MEMORY + 2])


EFFECT = Effect(
    name="motor_cogging",
    channel="T",
    domain="motor_angle",
    equation="T_motor = A sin(N motor_angle + phase)",
    parameters=(
        Parameter("cycles", "1", 1.0, 200.0, 37.0, "ASSUMPTION: slots of the armature; hardware.md 1.2"),
        Parameter("amplitude", "N m", 0.0, 0.5, 0.03, ASSUMED),
        PHASE,
        MOTOR_CHOICE,
    ),
    source=CATALOGUE,
    terms=(Term(Hook.MOTOR_TORQUE, formula),),
)
