"""One encoder sits off its centre: first and second harmonic of its own turn.

The stage names the encoder: axis the absolute, roller the incremental, aux the auxiliary one."""

from math import sin

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, PHASE, Effect, Parameter, Term
from plant.effects.signals import ANGLE, MEMORY


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the error of the reading, rad at the axis."""
    turn = p[MEMORY] * x[ANGLE]
    return p[MEMORY + 1] * sin(turn + p[MEMORY + 2]) + p[MEMORY + 3] * sin(2.0 * turn + p[MEMORY + 4])


EFFECT = Effect(
    name="encoder_eccentricity",
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
    source=CATALOGUE,
    terms=(Term("encoder", formula),),
    stages=("axis", "roller", "aux"),
)
