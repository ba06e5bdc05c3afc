"""Friction that grows with the torque the gears transmit."""

from plant.compiled import Floats
from plant.effects.base import Effect, Parameter, Term
from plant.effects.signals import COULOMB, STICTION, TORQUE, Hook


def formula(x: Floats, coefficient: float) -> None:
    """Add mu |T| to Tc and Ts."""
    change = coefficient * abs(x[TORQUE])
    x[COULOMB] += change
    x[STICTION] += change


EFFECT = Effect(
    name="load_friction",
    catalogue_row=7,
    channel="T",
    domain="current",
    equation="Tc, Ts -> Tc, Ts + mu |T_gear|",
    parameters=(
        Parameter("coefficient", "1", 0.0, 0.5, 0.1, "ASSUMPTION: gear efficiency 0.9 to 1, hardware.md 2.2"),
    ),
    terms=(Term(Hook.FRICTION, formula),),
    odd=True,
)
