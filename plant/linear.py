"""An axis as a linear system around steady sliding: what controllers and bounds are made from."""

from math import exp

import numpy as np

from plant.compiled import Floats
from plant.deadzone import ohms, step_torque
from plant.gears import RATIO
from plant.parts import AxisModel, PlantModel

ANGLE, RATE, BRISTLE, ROTOR_A, SPEED_A, TORQUE_A, ROTOR_B, SPEED_B, TORQUE_B, SIZE = range(10)
"""States: axis angle and rate, bristle torque; angle and rate of rotor A, its motor's torque; B's as well."""


def stepped(a: Floats, b: Floats, seconds: float) -> tuple[Floats, Floats]:
    """Matrices of state and input over a time in which the input is held: exact."""
    from scipy.linalg import expm  # of the extra `calibrate`

    n = len(a)
    both = np.zeros((n + b.shape[1], n + b.shape[1]))
    both[:n, :n], both[:n, n:] = a, b
    step = expm(both * seconds)
    return step[:n, :n], step[:n, n:]


def continuous(model: PlantModel, part: AxisModel, rate: float) -> tuple[Floats, Floats, Floats]:
    """Matrices at steady sliding with `rate`, rad/s above 0: state, motor A's duty, a torque on the axis.

    Both trains are in contact. The duty is in PWM steps, the torque in N m. SI units, rotors and motor as
    seen at the axis.

    A leads: its EMF brakes. So does that of B behind a switching stage, as a bias keeps its current flowing.
    By the superposition B gives a steady torque (plant/kernels/drive.py).
    """
    f, motor, gear = part.friction, part.motor, part.gear
    x = (rate / f.stribeck_rate.si) ** f.stribeck_exponent.si
    excess = (f.stiction.si - f.coulomb.si) * exp(-x)
    level = f.coulomb.si + excess
    slope = -excess * x * f.stribeck_exponent.si  # rate times dg/drate, N m
    rotor, load = motor.rotor_inertia.si * RATIO**2, part.inertia.si
    k, c, sigma0 = gear.stiffness.si / 2, gear.damping.si / 2, f.bristle_stiffness.si
    ohm = ohms(motor)
    constant, electric = motor.torque_constant.si * RATIO, motor.inductance.si / ohm
    per_step = step_torque(model, motor)
    a, b, push = np.zeros((SIZE, SIZE)), np.zeros((SIZE, 1)), np.zeros((SIZE, 1))
    a[ANGLE, RATE] = 1.0
    a[BRISTLE, [RATE, BRISTLE]] = sigma0 * slope / level, -sigma0 * rate / level
    a[RATE, [RATE, BRISTLE]] = -f.viscous.si / load, -1.0 / load
    a[RATE] -= f.bristle_damping.si / sigma0 / load * a[BRISTLE]
    push[RATE, 0] = 1.0 / load
    for angle, speed in ((ROTOR_A, SPEED_A), (ROTOR_B, SPEED_B)):
        twist = np.zeros(SIZE)
        twist[[ANGLE, RATE, angle, speed]] = -k, -c, k, c
        a[RATE] += twist / load
        a[angle, speed] = 1.0
        a[speed] -= twist / rotor
    for speed, torque in ((SPEED_A, TORQUE_A), (SPEED_B, TORQUE_B)):
        a[speed, torque] = 1.0 / rotor
        a[torque, torque] = -1.0 / electric
        if speed == SPEED_A or motor.diode_drop:
            a[torque, speed] = -(constant**2) / ohm / electric
    b[TORQUE_A, 0] = per_step / electric
    return a, b, push
