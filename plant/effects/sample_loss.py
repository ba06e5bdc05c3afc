"""Packets of 25 samples are missing, samples are repeated."""

from plant.effects.base import ASSUMED, Effect, Parameter, Term
from plant.effects.signals import Hook

EFFECT = Effect(
    name="sample_loss",
    catalogue_row=38,
    channel="S",
    domain="clock",
    equation="a packet is lost with probability p, a sample repeats its predecessor with probability q",
    parameters=(
        Parameter(
            "packet_loss", "1", 0.0, 0.9, 0.02, "paper 3.4: packets of 25 samples every 250 ms; share assumed"
        ),
        Parameter("repeats", "1", 0.0, 0.5, 0.0, ASSUMED),
    ),
    terms=(Term(Hook.LOG),),
)
