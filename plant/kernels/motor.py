"""One motor's part of a grid step: duty, winding, torque on the rotor, motion of the rotor."""

from math import exp

from plant.compiled import Floats, inner
from plant.effects.signals import Hook
from plant.kernels import layout as at
from plant.kernels.drive import back_emf, winding
from plant.kernels.stage import stage

COMMAND = int(Hook.COMMAND)
RESISTANCE = int(Hook.RESISTANCE)
CONSTANT = int(Hook.CONSTANT)
MOTOR_TORQUE = int(Hook.MOTOR_TORQUE)


@inner
def superposed(
    w: Floats, m: int, applied: float, speed: float, constant: float, heated: float, h: float
) -> tuple[float, float]:
    """Return the current of motor `m` after a step and its mean, A, by the paper's superposition.

    applied: mean voltage, V. speed: rad/s, the way the motor pulls. heated: ohm, on top of the declared loop.
    """
    resistance = w[at.RESISTANCE]
    decay = w[at.CURRENT_DECAY]
    blend = w[at.CURRENT_BLEND]
    if heated != 0.0:
        resistance += heated
        decay = exp(-resistance * h / w[at.INDUCTANCE])
        blend = (1.0 - decay) * w[at.INDUCTANCE] / (resistance * h)
    leads = w[at.MEAN_DUTY + m] >= w[at.MEAN_DUTY + 1 - m]
    opposing = back_emf(speed, constant, applied, leads, w[at.DIODE], w[at.DIODE_DROP])
    goal = (applied - opposing) / resistance
    return winding(w[at.MOTORS + m * at.MOTOR_SIZE + at.M_CURRENT], goal, decay, blend)


@inner
def motor_step(w: Floats, m: int, voltage: float, h: float, sums: int) -> float:
    """Advance winding and rotor of motor `m` (0: A, pulls +; 1: B, pulls -); return its supply current, A.

    sums: where the effects on this motor lie, zero without effects.
    """
    o = at.MOTORS + m * at.MOTOR_SIZE
    side = 1.0 - 2.0 * m
    rate = w[o + at.M_RATE]
    middle = 1.5 * rate - 0.5 * w[o + at.M_RATE_BEFORE]
    duty = min(1.0, max(0.0, w[at.MEAN_DUTY + m] + w[sums + COMMAND]))
    constant = w[at.TORQUE_CONSTANT] * (1.0 + w[sums + CONSTANT])
    speed = side * middle
    if w[at.PULSE] > 0.0:
        valley, mean, drawn = stage(
            w, w[at.VALLEY + m], duty, voltage, constant * speed, w[sums + RESISTANCE], h
        )
        w[at.VALLEY + m] = valley
        current = mean
    else:
        current, mean = superposed(w, m, duty * voltage, speed, constant, w[sums + RESISTANCE], h)
        drawn = duty * mean
    load = w[o + at.M_GEAR] / w[at.RATIO] + w[at.ROTOR_DRAG] * middle
    torque = side * constant * mean + w[sums + MOTOR_TORQUE] - load
    w[o + at.M_CURRENT] = current
    w[o + at.M_RATE_BEFORE] = rate
    rate += h * torque / w[at.ROTOR_INERTIA]
    w[o + at.M_RATE] = rate
    w[o + at.M_ANGLE] += h * rate
    return drawn
