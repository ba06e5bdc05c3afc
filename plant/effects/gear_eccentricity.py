"""A shaft of the train runs out: torque at the axis and, by its pitch error, twist between motor and axis.

`amplitude` is torque at the axis; `kinematic` is the angle by which the trains lead, at the axis."""

from math import sin

from plant.compiled import Floats
from plant.effects.base import ASSUMED, PHASE, SHAFTS, Effect, Parameter, Term
from plant.effects.signals import ANGLE, Hook


def formula(x: Floats, order: float, amplitude: float, phase: float) -> float:
    """Return the torque, N m at the axis."""
    return amplitude * sin(order * x[ANGLE] + phase)


def twist(x: Floats, order: float, kinematic: float, phase: float) -> float:
    """Return the kinematic error, rad at the axis."""
    return kinematic * sin(order * x[ANGLE] + phase)


EFFECT = Effect(
    name="gear_eccentricity",
    catalogue_row=11,
    channel="T",
    domain="axis_angle",
    equation="T = A sin(order angle + phase); twist = B sin(order angle + phase)",
    parameters=(
        Parameter("amplitude", "N m", 0.0, 200.0, 23.0, "design.md: 15 to 25 N m give rows E3 and E5"),
        Parameter("kinematic", "arcsec", 0.0, 120.0, 0.0, ASSUMED),
        PHASE,
    ),
    source="paper 4: imbalances in the gears",
    terms=(Term(Hook.AXIS_TORQUE, formula), Term(Hook.TRANSMISSION, twist)),
    stages=SHAFTS,
)
