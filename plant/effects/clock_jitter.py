"""The time stamps of the log jitter."""

from plant.compiled import Floats, inner
from plant.effects.base import ASSUMED, CATALOGUE, Effect, Parameter, Term
from plant.effects.signals import MEMORY, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the deviation of a time stamp, s."""
    return p[MEMORY]


EFFECT = Effect(
    name="clock_jitter",
    channel="S",
    domain="clock",
    equation="t -> t + s n, n standard normal",
    parameters=(Parameter("deviation", "s", 0.0, 0.005, 0.0005, ASSUMED),),
    source=CATALOGUE,
    terms=(Term(Hook.LOG, formula),),
)
