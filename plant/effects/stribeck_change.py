"""Static friction, Stribeck rate or exponent differ from the declared ones."""

from plant.compiled import Floats
from plant.effects.base import ASSUMED, Effect, Parameter, Term
from plant.effects.signals import STICTION, STRIBECK_EXPONENT, STRIBECK_RATE, Hook


def formula(x: Floats, stiction_factor: float, velocity_factor: float, exponent_change: float) -> None:
    """Scale Ts and the Stribeck rate, shift the exponent."""
    x[STICTION] *= stiction_factor
    x[STRIBECK_RATE] *= velocity_factor
    x[STRIBECK_EXPONENT] += exponent_change


EFFECT = Effect(
    name="stribeck_change",
    catalogue_row=1,
    channel="T",
    domain="velocity",
    equation="Ts -> a Ts, ws -> b ws, delta -> delta + d",
    parameters=(
        Parameter("stiction_factor", "1", 0.3, 3.0, 1.3, ASSUMED),
        Parameter("velocity_factor", "1", 0.2, 5.0, 1.0, ASSUMED),
        Parameter("exponent_change", "1", -1.5, 2.0, 0.0, "hardware.md 1.1: delta 0.5 to 2"),
    ),
    terms=(Term(Hook.FRICTION, formula),),
    odd=True,
)
