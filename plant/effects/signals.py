"""What an effect's formula may depend on: the places in its signal vector, and the hooks it may act at.

The kernel fills the vector at every step; calibration fills it from the columns of a log. SI units.
"""

from enum import IntEnum
from typing import Final

TIME: Final = 0  # s since start
ANGLE: Final = 1  # axis, rad
RATE: Final = 2  # axis, rad/s
MOTOR_ANGLE: Final = 3  # of the motor concerned, rad
MOTOR_RATE: Final = 4  # rad/s
CURRENT: Final = 5  # of the motor concerned, A
COMMAND: Final = 6  # duty of the motor concerned, 0..1
TORQUE: Final = 7  # through both gear trains, N m at the axis
REVERSAL: Final = 8  # axis travel since the last reversal, rad (signed)
TEMPERATURE: Final = 9  # ambient, degC
SUPPLY_CURRENT: Final = 10  # sum of duty * current, A
ACCELERATION: Final = 11  # axis, rad/s2
MOTOR: Final = 12  # 0: A, 1: B
LAGGING: Final = 13  # 1: the motor concerned is the one that holds the counter torque
ENCODER: Final = 14  # 0 incremental, 1 absolute, 2 auxiliary
SIGNALS: Final = 16
# behind them the friction parameters of this step, which friction effects change in place
SIGMA0: Final = 16  # N m/rad
SIGMA1: Final = 17  # N m s/rad
SIGMA2: Final = 18  # N m s/rad
COULOMB: Final = 19  # N m
STICTION: Final = 20  # N m
STRIBECK_RATE: Final = 21  # rad/s
STRIBECK_EXPONENT: Final = 22
VECTOR: Final = 24  # length of the whole vector

MEMORY: Final = 4  # parameters start here in an effect's numbers; before them its memory and its seed
SEED: Final = 3


class Hook(IntEnum):
    """Where in the step an effect acts, and the unit of its formula's value."""

    # of each motor
    COMMAND = 0  # added to its duty
    RESISTANCE = 1  # ohm, added to its winding
    CONSTANT = 2  # relative change of its torque constant
    MOTOR_TORQUE = 3  # N m at the motor
    CURRENT = 4  # A, added to its reading
    # of the axis
    SUPPLY = 5  # V, added to the supply
    FRICTION = 6  # changes the friction parameters in place; value unused
    AXIS_TORQUE = 7  # N m at the axis, positive accelerates
    TRANSMISSION = 8  # rad at the axis, added to the twist of both trains
    INCREMENTAL = 9  # rad, added to the reading
    ABSOLUTE = 10
    AUXILIARY = 11
    # not in the step
    SWITCH = 12  # changes parameters of the axis once (plant/world.py); the formula is for calibration
    LOG = 13  # a delayed reading (plant/axis.py) or the host's log writer


MOTOR_HOOKS: Final = 5
HOOK_COUNT: Final = 12
