"""One grid step of one axis: leapfrog for the mechanics, exact updates for the windings and the bristles.

Rates live at grid points, angles and the bristle half a step later. So one evaluation of the torques per step
is second order, and springs keep their energy. Rate-dependent torques use the rate extrapolated to the step's
middle.
"""

from plant.compiled import Floats, inner
from plant.effects.signals import Hook
from plant.kernels import layout as at
from plant.kernels.drive import train
from plant.kernels.friction import relax, stribeck, torque
from plant.kernels.hooks import evaluate
from plant.kernels.motor import motor_step
from plant.kernels.stage import rail

TRANSMISSION = at.SUMS + int(Hook.TRANSMISSION)
AXIS_TORQUE = at.SUMS + int(Hook.AXIS_TORQUE)
SUPPLY = at.SUMS + int(Hook.SUPPLY)
INCREMENTAL = at.SUMS + int(Hook.INCREMENTAL)


@inner
def gears(w: Floats, rate: float, error: float) -> float:
    """Return the torque of both trains on the axis, N m, at the step's middle; keep each one's."""
    sum_of_both = 0.0
    scale = 1.0 / w[at.RATIO]
    for m in range(2):
        o = at.MOTORS + m * at.MOTOR_SIZE
        motor_rate = 1.5 * w[o + at.M_RATE] - 0.5 * w[o + at.M_RATE_BEFORE]
        push = train(
            w[o + at.M_ANGLE] * scale - w[at.ANGLE] + error,
            motor_rate * scale - rate,
            w[at.GEAR_STIFFNESS],
            w[at.GEAR_DAMPING],
            w[at.HALF_PLAY],
        )
        w[o + at.M_GEAR] = push
        sum_of_both += push
    return sum_of_both


@inner
def axis_step(w: Floats, t: float, h: float) -> None:
    """Advance one axis from `t` to `t + h`, s."""
    rate = w[at.RATE]
    middle = 1.5 * rate - 0.5 * w[at.RATE_BEFORE]
    friction = at.DECLARED_FRICTION
    voltage = rail(w)
    effects = w[at.ROWS_ALL] > 0.0
    if effects:
        evaluate(w, t + 0.5 * h, h)
        if w[at.AWAKE] == 0.0:  # a counter counts from where it wakes up, whatever its error is there
            w[at.INCREMENTAL_ZERO] += w[INCREMENTAL]
            w[at.AWAKE] = 1.0
        friction = at.FRICTION_NOW
        voltage += w[SUPPLY]
    drive = gears(w, middle, w[TRANSMISSION])
    w[at.SUPPLY_CURRENT] = motor_step(w, 0, voltage, h, at.SUMS) + motor_step(w, 1, voltage, h, at.SUMS_OF_B)

    brake = torque(middle, w[at.BRISTLE], w[at.STRIBECK], w, friction)
    # a buffer pushes as a train's teeth do, once its play, half of the travel, is used up
    stop = train(
        w[at.ANGLE] - w[at.STOP_MIDDLE], middle, w[at.STOP_STIFFNESS], w[at.STOP_DAMPING], w[at.STOP_REACH]
    )
    acceleration = (drive + w[AXIS_TORQUE] - brake - stop) / w[at.INERTIA]
    new_rate = rate + h * acceleration
    g = stribeck(new_rate, w, friction)
    w[at.BRISTLE] = relax(w[at.BRISTLE], new_rate, g, h)
    w[at.STRIBECK] = g
    w[at.FRICTION] = brake
    w[at.ACCELERATION] = acceleration
    w[at.RATE_BEFORE] = rate
    w[at.RATE] = new_rate
    if new_rate * w[at.DIRECTION] < 0.0 or w[at.DIRECTION] == 0.0:
        w[at.DIRECTION] = 1.0 if new_rate > 0.0 else (-1.0 if new_rate < 0.0 else 0.0)
        w[at.REVERSED_AT] = w[at.ANGLE]
    w[at.ANGLE] += h * new_rate
    w[at.STEP] += 1.0
