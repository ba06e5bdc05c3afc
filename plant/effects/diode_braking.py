"""The lagging motor drives current through its freewheel diode and brakes."""

from plant.compiled import Floats
from plant.effects.base import Effect, Parameter, Term
from plant.effects.signals import MOTOR, MOTOR_RATE, Hook


def formula(
    x: Floats, share: float, drop: float, torque_constant: float, resistance: float, ratio: float
) -> float:
    """Return the braking torque of the motor concerned, N m at the axis."""
    speed = x[MOTOR_RATE] if x[MOTOR] == 0.0 else -x[MOTOR_RATE]
    pull = max(0.0, -speed * torque_constant - drop)
    return (share * torque_constant * ratio * pull / resistance) * (1.0 if x[MOTOR] == 0.0 else -1.0)


EFFECT = Effect(
    name="diode_braking",
    catalogue_row=27,
    channel="T",
    domain="velocity",
    equation="T = a K N i_d, R i_d = K |w_motor| - drop, on the motor that turns against its pull",
    parameters=(
        Parameter(
            "share", "1", 0.0, 1.0, 1.0, "hardware.md 2.3: 0 is the paper's superposition, 1 the real diode"
        ),
        Parameter("drop", "V", 0.0, 1.5, 0.0, "ASSUMPTION: forward voltage of the freewheel diode"),
    ),
    source="hardware.md 2.3",
    terms=(Term(Hook.SWITCH, formula),),
    constants=("torque_constant", "resistance", "ratio"),
    switches={"share": "diode", "drop": "diode_drop"},
    odd=True,
)
