"""One encoder drifts with the ambient temperature."""

from plant.compiled import Floats
from plant.effects.base import ASSUMED, Effect, Parameter, Term
from plant.effects.signals import TEMPERATURE

REFERENCE = 20.0  # degC


def formula(x: Floats, drift: float) -> float:
    """Return the error of the reading, rad at the axis."""
    return drift * (x[TEMPERATURE] - REFERENCE)


EFFECT = Effect(
    name="encoder_thermal_drift",
    catalogue_row=35,
    channel="S",
    domain="temperature",
    equation="reading -> angle + a (temperature - 20 degC)",
    parameters=(
        Parameter("drift", "arcsec/K", -60.0, 60.0, 2.0, ASSUMED),
        Parameter("encoder", "1", 0.0, 2.0, 1.0, "choice: 0 incremental, 1 absolute, 2 auxiliary"),
    ),
    terms=(Term("encoder", formula),),
)
