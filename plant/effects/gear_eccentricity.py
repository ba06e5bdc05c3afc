"""A shaft of the train runs out: torque at the axis and, by its pitch error, twist between motor and axis.

`amplitude` is torque at the axis; `kinematic` is the angle by which the trains lead, at the axis."""

from math import sin

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, PHASE, SHAFTS, Effect, Parameter, Term
from plant.effects.signals import ANGLE, MEMORY, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the torque, N m at the axis."""
    return p[MEMORY + 1] * sin(p[MEMORY] * x[ANGLE] + p[MEMORY + 3])


@inner
def twist(x: Floats, p: Floats) -> float:
    """Return the kinematic error, rad at the axis."""
    return p[MEMORY + 2] * sin(p[MEMORY] * x[ANGLE] + p[MEMORY + 3])


EFFECT = Effect(
    name="gear_eccentricity",
    channel="T",
    domain="axis_angle",
    equation="T = A sin(order angle + phase); twist = B sin(order angle + phase)",
    parameters=(
        Parameter("amplitude", "N m", 0.0, 200.0, 23.0, "design.md: 15 to 25 N m give rows E3 and E5"),
        Parameter("kinematic", "arcsec", 0.0, 120.0, 0.0, ASSUMED),
        PHASE,
    ),
    source="paper 4: imbalances in the gears; " + CATALOGUE,
    terms=(Term(Hook.AXIS_TORQUE, formula), Term(Hook.TRANSMISSION, twist)),
    stages=SHAFTS,
)
