"""The bearing preload changes: Ts and sigma2 scale together."""

from plant.compiled import Floats
from plant.effects.base import Effect, Parameter, Term
from plant.effects.signals import COULOMB, SIGMA2, STICTION, TIME, Hook


def formula(x: Floats, change: float, start: float, duration: float) -> None:
    """Scale Ts and sigma2 by a ramp in time."""
    share = (x[TIME] - start) / duration
    share = min(1.0, max(0.0, share))
    factor = 1.0 + change * share
    x[STICTION] = max(x[COULOMB], x[STICTION] * factor)
    x[SIGMA2] *= factor


EFFECT = Effect(
    name="preload_change",
    catalogue_row=9,
    channel="T",
    domain="time",
    equation="Ts, sigma2 -> (1 + a ramp((t - t0) / tau)) Ts, sigma2",
    parameters=(
        Parameter(
            "change", "1", -0.7, 2.0, 0.5, "paper Table 2: between the two preloads Ts x2.4, sigma2 x1.7"
        ),
        Parameter("start", "s", -1e5, 1e5, 0.0, "free: when it happens"),
        Parameter("duration", "s", 0.01, 1e5, 1.0, "free: a step or a slow trend"),
    ),
    terms=(Term(Hook.FRICTION, formula),),
    odd=True,
)
