"""A counter of the log wraps or saturates."""

from plant.effects.base import ASSUMED, Effect, Parameter, Term
from plant.effects.signals import Hook

EFFECT = Effect(
    name="log_wrap",
    catalogue_row=39,
    channel="S",
    domain="clock",
    equation="column -> column modulo 2^bits, signed (mode 0), or clipped to it (mode 1)",
    parameters=(
        Parameter(
            "column",
            "1",
            0.0,
            4.0,
            2.0,
            "choice: 0 effort, 1 position, 2 velocity, 3 currents, 4 tachometers",
        ),
        Parameter("bits", "1", 4.0, 29.0, 8.0, ASSUMED),
        Parameter("mode", "1", 0.0, 1.0, 0.0, "choice: 0 wrap, 1 saturate"),
    ),
    terms=(Term(Hook.LOG),),
)
