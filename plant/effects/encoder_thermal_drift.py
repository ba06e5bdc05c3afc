"""One encoder drifts with the ambient temperature."""

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, Effect, Parameter, Term
from plant.effects.signals import MEMORY, TEMPERATURE

REFERENCE = 20.0  # degC


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the error of the reading, rad at the axis."""
    return p[MEMORY] * (x[TEMPERATURE] - REFERENCE)


EFFECT = Effect(
    name="encoder_thermal_drift",
    channel="S",
    domain="temperature",
    equation="reading -> angle + a (temperature - 20 degC)",
    parameters=(
        Parameter("drift", "arcsec/K", -60.0, 60.0, 2.0, ASSUMED),
        Parameter("encoder", "1", 0.0, 2.0, 1.0, "choice: 0 incremental, 1 absolute, 2 auxiliary"),
    ),
    source=CATALOGUE,
    terms=(Term("encoder", formula),),
)
