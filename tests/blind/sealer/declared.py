"""What everybody knows of the drive: the paper's Tables 1 and 2, the gear train, the scales of the log.

Source of every number: the paper (P), its arithmetic (I) or an assumption (A) the log format or the design
notes state.
"""

import math
from typing import NamedTuple

ARCSEC = math.pi / 648000.0  # rad
TURN = 2.0 * math.pi
GEAR_RATIO = (113 / 27) * (123 / 21) * (250 / 17)  # P: three stages
ORDERS = {  # cycles per turn of the axis (I: tooth counts)
    "axis": 1.0,
    "shaft2": 250 / 17,
    "shaft1": 250 / 17 * 123 / 21,
    "motor": GEAR_RATIO,
    "roller": 24.5,  # P: 735:30
    "mesh3": 250.0,
    "mesh2": 250 / 17 * 123,
    "mesh1": 250 / 17 * 123 / 21 * 113,
}
TEETH = {"shaft2": 123, "shaft1": 113, "motor": 27}  # teeth of the larger gear on the shaft

POSITION_COUNTS = 2**29  # P: RCN829
ROLLER_COUNTS = 112_896_000  # I: 4.608e6 x 24.5 per turn of the axis
TACH_COUNTS = 4096  # A: per motor turn
AUX_COUNTS = 2**17 * 10.8  # P: A25s through 1:10.8
ADC_A_PER_COUNT = 0.0061  # A: log format
ADC_TOP = 1023
PWM_TOP = 3000  # A: steps of the supply
SUPPLY_V = 24.0  # P
TICK_S = 0.005  # P: interrupt period
ROW_TICKS = 2  # P: 10 ms rows
BACKLASH_MOTOR_DEG = 21.0  # P: motor to bull gear, whole gap, at the motor shaft

SIGMA_0 = 5.9e6  # A: N m/rad, design notes
SIGMA_1 = 3.9e3  # A: N m s/rad, passivity bound
DELTA = 2.0  # A: Stribeck exponent
TORQUE_CONSTANT = 0.39  # A: N m/A = V s/rad
RESISTANCE = 2.2  # A: ohm
TAU_ELECTRIC_S = 2.0e-3  # A: L/R
ROTOR = 8.0e-4  # A: kg m2 each


class Friction(NamedTuple):
    """Table 2: about the axis, N m s/rad, N m, N m, rad/s."""

    viscous: float
    coulomb: float
    breakaway: float
    stribeck: float


class Axis(NamedTuple):
    """Table 1 (and the run-down test): kg m2, N m/rad."""

    inertia: float
    stiffness: float


AXES = {"ra": Axis(1760.0, 3.08e6), "dec": Axis(579.0, 2.46e6)}
RA_BEFORE_WEIGHTS = 2200.0  # kg m2, Table 1
FRICTION = {"low": Friction(6700.0, 229.0, 621.0, 4e-4), "high": Friction(11300.0, 217.0, 1490.0, 7e-4)}
TOLERANCE = 0.20  # A: a declared mechanical figure may be off by this much without being an effect
SIGMA_0_TOLERANCE = math.log(1.7)  # A: sigma_0 is not published; within this factor it is no effect
