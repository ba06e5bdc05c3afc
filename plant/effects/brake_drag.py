"""Something starts to drag: a constant torque against the motion, from one moment to another."""

from plant.compiled import Floats
from plant.effects.base import ASSUMED, Effect, Parameter, Term
from plant.effects.signals import COULOMB, STICTION, TIME, Hook


def formula(x: Floats, torque: float, start: float, duration: float) -> None:
    """Add the drag to Tc and Ts while it lasts."""
    if start <= x[TIME] < start + duration:
        x[COULOMB] += torque
        x[STICTION] += torque


EFFECT = Effect(
    name="brake_drag",
    catalogue_row=33,
    channel="T",
    domain="time",
    equation="Tc, Ts -> Tc, Ts + T_drag for start <= t < start + duration",
    parameters=(
        Parameter("torque", "N m", 0.0, 400.0, 60.0, ASSUMED),
        Parameter("start", "s", -1e6, 1e6, 0.0, "free: when it happens"),
        Parameter("duration", "s", 0.0, 1e9, 1e6, "free: for how long"),
    ),
    terms=(Term(Hook.FRICTION, formula),),
    odd=True,
)
