"""Friction that grows with the torque the gears transmit."""

from plant.compiled import Floats, inner
from plant.effects.base import CATALOGUE, Effect, Parameter, Term
from plant.effects.signals import COULOMB, MEMORY, STICTION, TORQUE, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
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
    parameters=(
        Parameter("coefficient", "1", 0.0, 0.5, 0.1, "ASSUMPTION: gear efficiency 0.9 to 1, hardware.md 2.2"),
    ),
    source=CATALOGUE,
    terms=(Term(Hook.FRICTION, formula),),
    odd=True,
)
