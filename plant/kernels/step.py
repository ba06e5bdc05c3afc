"""One grid step of one axis: leapfrog for the mechanics, exact updates for the windings and the bristles.

Rates live at grid points, angles and the bristle half a step later, so one evaluation of the torques per step is
second order, and springs keep their energy. Rate-dependent torques use the rate extrapolated to the step's middle.
"""

from plant.compiled import inner
from plant.effects import signals as sig
from plant.effects.signals import Hook
from plant.kernels import layout as at
from plant.kernels.drive import train
from plant.kernels.friction import relax, stribeck, torque
from plant.kernels.hooks import any_effect, remember, total, used
from plant.kernels.motor import motor_torque

TRANSMISSION = int(Hook.TRANSMISSION)
FRICTION = int(Hook.FRICTION)
AXIS_TORQUE = int(Hook.AXIS_TORQUE)
SUPPLY = int(Hook.SUPPLY)
SWITCH = int(Hook.SWITCH)
END = int(Hook.LOG)


@inner
def gears(w, rate, effects):  # type: ignore[no-untyped-def]
    """Return the torque of both trains on the axis, N m, at the step's middle; keep each one's."""
    error = total(w, TRANSMISSION) if effects else 0.0
    sum_of_both = 0.0
    for m in range(2):
        o = at.MOTORS + m * at.MOTOR_SIZE
        motor_rate = 1.5 * w[o + at.M_RATE] - 0.5 * w[o + at.M_RATE_BEFORE]
        push = train(
            w[o + at.M_ANGLE] / w[at.RATIO] - w[at.ANGLE] + error,
            motor_rate / w[at.RATIO] - rate,
            w[at.GEAR_STIFFNESS],
            w[at.GEAR_DAMPING],
            w[at.HALF_PLAY],
        )
        w[o + at.M_GEAR] = push
        sum_of_both += push
    return sum_of_both


@inner
def fill_signals(w, t, rate):  # type: ignore[no-untyped-def]
    """Fill the signals of the axis and copy the declared friction behind them."""
    x = at.SIGNALS
    w[x + sig.TIME] = t
    w[x + sig.ANGLE] = w[at.ANGLE]
    w[x + sig.RATE] = rate
    w[x + sig.REVERSAL] = w[at.ANGLE] - w[at.REVERSED_AT]
    w[x + sig.TEMPERATURE] = w[at.TEMPERATURE] + w[at.WARMING] * t
    w[x + sig.SUPPLY_CURRENT] = w[at.SUPPLY_CURRENT]
    w[x + sig.ACCELERATION] = w[at.ACCELERATION]
    for k in range(at.FRICTION_SIZE):
        w[at.FRICTION_NOW + k] = w[at.DECLARED_FRICTION + k]


@inner
def axis_step(w, t, h):  # type: ignore[no-untyped-def]
    """Advance one axis from `t` to `t + h`, s."""
    rate = w[at.RATE]
    middle = 1.5 * rate - 0.5 * w[at.RATE_BEFORE]
    effects = any_effect(w)
    friction = w[at.DECLARED_FRICTION : at.DECLARED_FRICTION + at.FRICTION_SIZE]
    extra = 0.0
    voltage = w[at.VOLTAGE]
    if effects:
        fill_signals(w, t + 0.5 * h, middle)
    drive = gears(w, middle, effects)
    if effects:
        w[at.SIGNALS + sig.TORQUE] = drive
        if used(w, FRICTION):
            total(w, FRICTION)
            friction = w[at.FRICTION_NOW : at.FRICTION_NOW + at.FRICTION_SIZE]
        extra = total(w, AXIS_TORQUE)
        voltage += total(w, SUPPLY)

    supply = 0.0
    for m in range(2):
        supply += motor_torque(w, m, voltage, h, effects)
    w[at.SUPPLY_CURRENT] = supply

    brake = torque(middle, w[at.BRISTLE], w[at.STRIBECK], friction)
    acceleration = (drive + extra - brake) / w[at.INERTIA]
    new_rate = rate + h * acceleration
    g = stribeck(new_rate, friction)
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
    if effects:
        w[at.SIGNALS + sig.RATE] = new_rate
        w[at.SIGNALS + sig.ACCELERATION] = acceleration
        remember(w, SWITCH, END, h)
    w[at.STEP] += 1.0
