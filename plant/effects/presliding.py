"""Bristle stiffness and damping differ from the declared ones."""

from plant.compiled import Floats
from plant.effects.base import ASSUMED, Effect, Parameter, Term
from plant.effects.signals import SIGMA0, SIGMA1, Hook


def formula(x: Floats, stiffness_factor: float, damping_factor: float) -> None:
    """Scale sigma0 and sigma1."""
    x[SIGMA0] *= stiffness_factor
    x[SIGMA1] *= damping_factor


EFFECT = Effect(
    name="presliding",
    catalogue_row=2,
    channel="T",
    domain="reversal",
    equation="sigma0 -> a sigma0, sigma1 -> b sigma1",
    parameters=(
        Parameter("stiffness_factor", "1", 0.05, 20.0, 0.5, "hardware.md 1.1: sigma0 1e6 to 1e8 N m/rad"),
        Parameter("damping_factor", "1", 0.0, 5.0, 1.0, ASSUMED),
    ),
    terms=(Term(Hook.FRICTION, formula),),
    odd=True,
)
