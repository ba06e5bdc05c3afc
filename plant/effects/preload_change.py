"""The bearing preload changes: Ts and sigma2 scale together."""

from plant.compiled import Floats, inner
from plant.effects.base import CATALOGUE, Effect, Parameter, Term
from plant.effects.signals import COULOMB, MEMORY, SIGMA2, STICTION, TIME, Hook


@inner
def formula(x: Floats, p: Floats) -> float:
    """Scale Ts and sigma2 by a ramp in time."""
    share = (x[TIME] - p[MEMORY + 1]) / p[MEMORY + 2]
    share = min(1.0, max(0.0, share))
    factor = 1.0 + p[MEMORY] * share
    x[STICTION] = max(x[COULOMB], x[STICTION] * factor)
    x[SIGMA2] *= factor
    return 0.0


EFFECT = Effect(
    name="preload_change",
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
    source=CATALOGUE,
    terms=(Term(Hook.FRICTION, formula),),
    odd=True,
)
