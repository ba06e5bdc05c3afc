"""The trains wind up more than declared."""

from plant.compiled import Floats
from plant.effects.base import Effect, Parameter, Term
from plant.effects.signals import TORQUE, Hook


def formula(x: Floats, compliance: float) -> float:
    """Return the extra wind-up of the axis behind the motors, rad."""
    return -compliance * x[TORQUE]


EFFECT = Effect(
    name="shaft_compliance",
    catalogue_row=18,
    channel="K",
    domain="current",
    equation="twist -> twist - c T_gear",
    parameters=(
        Parameter(
            "compliance", "arcsec/(N m)", 0.0, 2.0, 0.1, "ASSUMPTION: Table 1 winds up 0.067 arcsec per N m"
        ),
    ),
    terms=(Term(Hook.SWITCH, formula),),
    switches={"compliance": "compliance"},
)
