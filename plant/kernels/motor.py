"""One motor's part of a grid step: duty, winding, torque on the rotor, motion of the rotor."""

from math import exp

from plant.compiled import inner
from plant.effects import signals as sig
from plant.effects.signals import Hook
from plant.kernels import layout as at
from plant.kernels.drive import back_emf, winding
from plant.kernels.hooks import remember, total, used

COMMAND = int(Hook.COMMAND)
RESISTANCE = int(Hook.RESISTANCE)
CONSTANT = int(Hook.CONSTANT)
MOTOR_TORQUE = int(Hook.MOTOR_TORQUE)


@inner
def motor_torque(w, m, voltage, h, effects):  # type: ignore[no-untyped-def]
    """Advance winding and rotor of motor `m` (0: A, pulls +; 1: B, pulls -); return duty * mean current, A."""
    o = at.MOTORS + m * at.MOTOR_SIZE
    side = 1.0 - 2.0 * m
    rate = w[o + at.M_RATE]
    middle = 1.5 * rate - 0.5 * w[o + at.M_RATE_BEFORE]
    duty = w[at.MEAN_DUTY + m]
    constant = w[at.TORQUE_CONSTANT]
    resistance = w[at.RESISTANCE]
    decay = w[at.CURRENT_DECAY]
    blend = w[at.CURRENT_BLEND]
    detent = 0.0
    if effects:
        x = at.SIGNALS
        w[x + sig.MOTOR] = m
        w[x + sig.MOTOR_ANGLE] = w[o + at.M_ANGLE]
        w[x + sig.MOTOR_RATE] = middle
        w[x + sig.CURRENT] = w[o + at.M_CURRENT]
        w[x + sig.COMMAND] = duty
        w[x + sig.LAGGING] = 1.0 if duty < w[at.MEAN_DUTY + 1 - m] else 0.0
        duty = min(1.0, max(0.0, duty + total(w, COMMAND)))
        constant *= 1.0 + total(w, CONSTANT)
        detent = total(w, MOTOR_TORQUE)
        if used(w, RESISTANCE):
            resistance += total(w, RESISTANCE)
            decay = exp(-resistance * h / w[at.INDUCTANCE])
            blend = (1.0 - decay) * w[at.INDUCTANCE] / (resistance * h)
            remember(w, RESISTANCE, RESISTANCE + 1, h)

    opposing = back_emf(side * middle, constant, w[at.DIODE], w[at.DIODE_DROP])
    goal = (duty * voltage - opposing) / resistance
    current, mean = winding(w[o + at.M_CURRENT], goal, decay, blend)
    torque = side * constant * mean + detent - w[o + at.M_GEAR] / w[at.RATIO] - w[at.ROTOR_DRAG] * middle
    w[o + at.M_CURRENT] = current
    w[o + at.M_RATE_BEFORE] = rate
    rate += h * torque / w[at.ROTOR_INERTIA]
    w[o + at.M_RATE] = rate
    w[o + at.M_ANGLE] += h * rate
    return duty * mean
