"""Something adds to the control effort behind the controller."""

from math import pi, sin

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, PHASE, Effect, Parameter, Term
from plant.effects.signals import LAGGING, MEMORY, MOTOR, TIME, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the change of the leading motor's duty."""
    if x[LAGGING] > 0.0:
        return 0.0
    wave = sin(2.0 * pi * p[MEMORY + 1] * x[TIME] + p[MEMORY + 2])
    if p[MEMORY + 3] > 0.5:
        wave = 1.0 if wave > 0.0 else -1.0
    return p[MEMORY] * (wave if x[MOTOR] == 0.0 else -wave)


EFFECT = Effect(
    name="command_disturbance",
    channel="T",
    domain="time",
    equation="u -> u + A sin(2 pi f t + phase), or its sign (shape 1); u > 0 pulls with motor A",
    parameters=(
        Parameter("amplitude", "1", 0.0, 0.5, 0.02, "share of full effort; " + ASSUMED),
        Parameter("frequency", "Hz", 0.001, 50.0, 0.8, ASSUMED),
        PHASE,
        Parameter("shape", "1", 0.0, 1.0, 0.0, "choice: 0 sine, 1 square"),
    ),
    source=CATALOGUE,
    terms=(Term(Hook.COMMAND, formula),),
)
