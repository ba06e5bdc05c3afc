"""One encoder sits off its centre: first and second harmonic of its own turn.

The stage names the encoder: axis the absolute, roller the incremental, aux the auxiliary one."""

from math import sin

from plant.compiled import Floats
from plant.effects.base import ASSUMED, PHASE, Effect, Parameter, Term
from plant.effects.signals import ANGLE


def formula(
    x: Floats, order: float, amplitude: float, phase: float, second: float, second_phase: float
) -> float:
    """Return the error of the reading, rad at the axis."""
    turn = order * x[ANGLE]
    return amplitude * sin(turn + phase) + second * sin(2.0 * turn + second_phase)


EFFECT = Effect(
    name="encoder_eccentricity",
    catalogue_row=20,
    channel="K",
    domain="axis_angle",
    equation="reading -> angle + A sin(order angle + phase) + B sin(2 order angle + phase2)",
    parameters=(
        Parameter(
            "amplitude", "arcsec", 0.0, 60.0, 2.0, "hardware.md 1.3: RCN 829 system accuracy +-1 to 2 arcsec"
        ),
        PHASE,
        Parameter("second", "arcsec", 0.0, 60.0, 0.0, ASSUMED),
        Parameter("second_phase", "rad", -3.2, 3.2, 0.0, "free: unknown mounting angle"),
    ),
    terms=(Term("encoder", formula),),
    stages=("axis", "roller", "aux"),
)
