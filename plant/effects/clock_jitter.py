"""The time stamps of the log jitter."""

from plant.effects.base import ASSUMED, Effect, Parameter, Term
from plant.effects.signals import Hook

EFFECT = Effect(
    name="clock_jitter",
    catalogue_row=37,
    channel="S",
    domain="clock",
    equation="t -> t + s n, n standard normal",
    parameters=(Parameter("deviation", "s", 0.0, 0.005, 0.0005, ASSUMED),),
    terms=(Term(Hook.LOG),),
)
