"""The lagging motor holds less counter torque than friction: teeth part at reversal."""

from plant.compiled import Floats
from plant.effects.base import ASSUMED, Effect, Parameter, Term
from plant.effects.signals import COMMAND, LAGGING, Hook


def formula(x: Floats, loss: float) -> float:
    """Return the change of the lagging motor's duty."""
    return -loss * x[COMMAND] if x[LAGGING] > 0.0 else 0.0


EFFECT = Effect(
    name="backlash_loss",
    catalogue_row=17,
    channel="K",
    domain="reversal",
    equation="duty of the lagging motor -> (1 - a) duty",
    parameters=(Parameter("loss", "1", 0.0, 1.0, 0.9, ASSUMED),),
    source="paper 2.2: 42 deg between the motors",
    terms=(Term(Hook.COMMAND, formula),),
)
