"""Friction that grows with the torque the gears transmit."""

from plant.compiled import inner
from plant.effects.base import CATALOGUE, Effect, Parameter, Term
from plant.effects.signals import TORQUE, COULOMB, STICTION, MEMORY, Hook


@inner
def formula(x, p):  # type: ignore[no-untyped-def]
    """Add mu |T| to Tc and Ts."""
    change = p[MEMORY] * abs(x[TORQUE])
    x[COULOMB] += change
    x[STICTION] += change
    return 0.0


EFFECT = Effect(
    name="load_friction",
    channel="T",
    domain="current",
    equation="Tc, Ts -> Tc, Ts + mu |T_gear|",
    parameters=(Parameter("coefficient", "1", 0.0, 0.5, 0.1, "ASSUMPTION: gear efficiency 0.9 to 1, hardware.md 2.2"),),
    source=CATALOGUE,
    terms=(Term(Hook.FRICTION, formula),),
    odd=True,
)
