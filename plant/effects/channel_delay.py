"""One column of the log is late.

The plant delays the reading itself; effort is delayed by the log writer."""

from plant.effects.base import Effect, Parameter, Term
from plant.effects.signals import Hook

EFFECT = Effect(
    name="channel_delay",
    catalogue_row=36,
    channel="S",
    domain="clock",
    equation="reading(t) -> reading(t - delay)",
    parameters=(
        Parameter(
            "column",
            "1",
            0.0,
            4.0,
            1.0,
            "choice: 0 effort, 1 position, 2 velocity, 3 currents, 4 tachometers",
        ),
        Parameter("delay", "s", 0.0, 0.12, 0.005, "ASSUMPTION: one control period"),
    ),
    terms=(Term(Hook.LOG),),
)
