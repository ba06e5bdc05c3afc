"""Part of the load swings on a spring: a fixed frequency at every speed."""

from math import pi

from plant.compiled import Floats
from plant.effects.base import ASSUMED, Effect, Parameter, Term
from plant.effects.signals import RATE, Hook


def formula(x: Floats, lead: float, rate: float, frequency: float, damping: float, inertia: float) -> float:
    """Return the torque of the second mass on the axis, N m (lead, rad, and rate are those of that mass)."""
    pulse = 2.0 * pi * frequency
    return inertia * (pulse * pulse * lead + 2.0 * damping * pulse * (rate - x[RATE]))


def update(
    x: Floats, dt: float, lead: float, rate: float, axis_rate: float, frequency: float, damping: float
) -> tuple[float, float, float]:
    """Return the memory: leapfrog of the second mass, whose lead is kept at the step's middle."""
    pulse = 2.0 * pi * frequency
    rate -= dt * (pulse * pulse * lead + 2.0 * damping * pulse * (rate - axis_rate))
    lead += dt * (rate - x[RATE])
    return lead, rate, x[RATE]


EFFECT = Effect(
    name="structural_mode",
    catalogue_row=19,
    channel="T",
    domain="time",
    equation="T = J2 (w0^2 y + 2 zeta w0 dy/dt), J2 d2(angle + y)/dt2 = -T; J2: part of the inertia",
    parameters=(
        Parameter("frequency", "Hz", 1.0, 45.0, 9.0, "ASSUMPTION: above the drive's 6 Hz"),
        Parameter("damping", "1", 0.001, 0.3, 0.02, ASSUMED),
        Parameter("inertia", "kg m2", 1.0, 1000.0, 200.0, ASSUMED),
    ),
    source="paper Table 1: lock-rotor modes",
    terms=(
        Term(
            Hook.AXIS_TORQUE,
            formula,
            update,
            memory=("lead", "rate", "axis_rate"),
            moving=("rate", "axis_rate"),
        ),
    ),
    switches={"inertia": "swinging"},
)
