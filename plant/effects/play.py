"""The coupling of one encoder has a gap: its reading stands still at a reversal until the gap is closed."""

from plant.compiled import Floats
from plant.effects.base import Effect, Parameter, Term
from plant.effects.signals import RATE


def formula(x: Floats, offset: float) -> float:
    """Return how far the encoder's shaft is from the middle of the gap, rad at the axis."""
    return offset


def update(x: Floats, dt: float, offset: float, gap: float) -> float:
    """Return the offset: the axis moves within the gap and pushes the encoder's shaft along at either end."""
    half = 0.5 * gap
    return min(max(offset - x[RATE] * dt, -half), half)


EFFECT = Effect(
    name="play",
    catalogue_row=16,
    channel="K",
    domain="reversal",
    equation="reading -> angle + e; de/dt = -w within |e| <= gap / 2 (the play operator)",
    parameters=(
        Parameter("gap", "arcsec", 0.0, 1200.0, 20.0, "ASSUMPTION: a worn coupling"),
        Parameter(
            "encoder",
            "1",
            0.0,
            2.0,
            2.0,
            "choice: 0 incremental, 1 absolute, 2 auxiliary (the one behind a gear of its own, 1:10.8)",
        ),
    ),
    source="paper 2.2: auxiliary encoder through a gear",
    terms=(Term("encoder", formula, update, memory=("offset",)),),
)
