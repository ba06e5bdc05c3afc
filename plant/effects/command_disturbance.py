"""Something adds to the control effort behind the controller."""

from math import pi, sin

from plant.compiled import Floats
from plant.effects.base import ASSUMED, PHASE, Effect, Parameter, Term
from plant.effects.signals import LAGGING, MOTOR, TIME, Hook


def formula(x: Floats, amplitude: float, frequency: float, phase: float, shape: float) -> float:
    """Return the change of the leading motor's duty."""
    if x[LAGGING] > 0.0:
        return 0.0
    wave = sin(2.0 * pi * frequency * x[TIME] + phase)
    if shape > 0.5:
        wave = 1.0 if wave > 0.0 else -1.0
    return amplitude * (wave if x[MOTOR] == 0.0 else -wave)


EFFECT = Effect(
    name="command_disturbance",
    catalogue_row=40,
    channel="T",
    domain="time",
    equation="u -> u + A sin(2 pi f t + phase), or its sign (shape 1); u > 0 pulls with motor A",
    parameters=(
        Parameter("amplitude", "1", 0.0, 0.5, 0.02, "share of full effort; " + ASSUMED),
        Parameter("frequency", "Hz", 0.001, 50.0, 0.8, ASSUMED),
        PHASE,
        Parameter("shape", "1", 0.0, 1.0, 0.0, "choice: 0 sine, 1 square"),
    ),
    terms=(Term(Hook.COMMAND, formula),),
)
