"""Interpolation error within a line of one encoder."""

from math import sin

from plant.compiled import Floats
from plant.effects.base import ASSUMED, PHASE, Effect, Parameter, Term
from plant.effects.signals import ANGLE


def formula(
    x: Floats, lines: float, amplitude: float, second: float, phase: float, second_phase: float
) -> float:
    """Return the error of the reading, rad at the axis."""
    line = lines * x[ANGLE]
    return amplitude * sin(line + phase) + second * sin(2.0 * line + second_phase)


EFFECT = Effect(
    name="encoder_subdivision",
    catalogue_row=21,
    channel="S",
    domain="axis_angle",
    equation="reading -> angle + A sin(lines angle + phase) + B sin(2 lines angle + phase2)",
    parameters=(
        Parameter("lines", "1", 100.0, 3e7, 32768.0, "hardware.md 1.3: RCN 700/800 has 32768 signal periods"),
        Parameter("amplitude", "arcsec", 0.0, 20.0, 0.2, ASSUMED),
        Parameter("second", "arcsec", 0.0, 20.0, 0.05, ASSUMED),
        PHASE,
        Parameter("encoder", "1", 0.0, 2.0, 1.0, "choice: 0 incremental, 1 absolute, 2 auxiliary"),
        Parameter("second_phase", "rad", -3.2, 3.2, 0.0, "free: unknown mounting angle"),
    ),
    terms=(Term("encoder", formula),),
)
