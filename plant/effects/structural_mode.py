"""Part of the load swings on a spring: a fixed frequency at every speed."""

from math import pi

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, Effect, Parameter, Term
from plant.effects.signals import MEMORY, RATE, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the torque of the second mass on the axis, N m (p[0]: its lead, rad; p[1]: its rate; p[2]: the
    axis').
    """
    pulse = 2.0 * pi * p[MEMORY]
    return p[MEMORY + 2] * (pulse * pulse * p[0] + 2.0 * p[MEMORY + 1] * pulse * (p[1] - x[RATE]))


@inner
def update(x: Floats, p: Floats, dt: float) -> None:
    """Leapfrog of the second mass, whose lead is kept at the step's middle."""
    pulse = 2.0 * pi * p[MEMORY]
    p[1] -= dt * (pulse * pulse * p[0] + 2.0 * p[MEMORY + 1] * pulse * (p[1] - p[2]))
    p[0] += dt * (p[1] - x[RATE])
    p[2] = x[RATE]


EFFECT = Effect(
    name="structural_mode",
    channel="T",
    domain="time",
    equation="T = J2 (w0^2 y + 2 zeta w0 dy/dt), J2 d2(angle + y)/dt2 = -T; J2: part of the inertia",
    parameters=(
        Parameter("frequency", "Hz", 1.0, 45.0, 9.0, "ASSUMPTION: above the drive's 6 Hz"),
        Parameter("damping", "1", 0.001, 0.3, 0.02, ASSUMED),
        Parameter("inertia", "kg m2", 1.0, 1000.0, 200.0, ASSUMED),
    ),
    source="paper Table 1: lock-rotor modes; " + CATALOGUE,
    terms=(Term(Hook.AXIS_TORQUE, formula, update),),
)
