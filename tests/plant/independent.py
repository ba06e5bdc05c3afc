"""The declared plant written down a second time and left to scipy's DOP853: equations (1) to (5), two trains
with play, no grid. Shares no code with the plant room; only the numbers come from the plant file.

Between two changes of duty the right-hand side is smooth but for contacts, current stops and the bristle at
reversal; the step control shortens its steps there.
"""

from collections.abc import Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from plant.parts import PlantModel

Floats = NDArray[np.float64]
RATIO = 113 / 27 * 123 / 21 * 250 / 17


@njit
def _motion(t, y, p, duty):  # type: ignore[no-untyped-def]
    """dy/dt of: angle, rate, bristle, (angle, rate, current) of motors A and B; SI units."""
    (inertia, rotor, stiffness, damping, play, resistance, inductance, constant, voltage,
     sigma0, sigma1, sigma2, coulomb, stiction, stribeck, exponent, ratio,
     end, buffer, buffer_damping) = p  # fmt: skip
    d = np.zeros(9)
    angle, rate, z = y[0], y[1], y[2]
    total = 0.0
    for m in range(2):
        side = 1.0 - 2.0 * m
        o = 3 + 3 * m
        twist, speed = y[o] / ratio - angle, y[o + 1] / ratio - rate
        push = 0.0
        if twist > play:
            push = max(0.0, stiffness * (twist - play) + damping * speed)
        elif twist < -play:
            push = min(0.0, stiffness * (twist + play) + damping * speed)
        total += push
        applied = duty[m] * voltage
        emf = constant * side * y[o + 1]
        if emf < 0.0:
            emf = max(emf, -applied) if duty[m] >= duty[1 - m] else 0.0
        current = max(0.0, y[o + 2])
        flow = (applied - emf - resistance * current) / inductance
        d[o] = y[o + 1]
        d[o + 1] = (side * constant * current - push / ratio) / rotor
        d[o + 2] = 0.0 if y[o + 2] <= 0.0 and flow < 0.0 else flow
    g = (coulomb + (stiction - coulomb) * np.exp(-((abs(rate) / stribeck) ** exponent))) / sigma0
    slip = rate - abs(rate) * z / g
    d[0] = rate
    if angle > end:
        total -= max(0.0, buffer * (angle - end) + buffer_damping * rate)
    d[1] = (total - sigma0 * z - sigma1 * slip - sigma2 * rate) / inertia
    d[2] = slip
    return d


def rates(
    model: PlantModel, manoeuvre: Sequence[tuple[float, float, float]], seconds: float, sample_s: float = 0.01
) -> Floats:
    """Rate of the RA axis, rad/s, every `sample_s` from `sample_s` on. manoeuvre: (s, duty A, duty B).

    Effects, drag, the low stop and sigma1's decay are not written down here: the model must have none.
    """
    axis, motor, friction = model.axes.ra, model.axes.ra.motor, model.axes.ra.friction
    assert not axis.effects and not motor.drag.si and not friction.bristle_decay.si
    resistance = motor.resistance.si + motor.switch_resistance.si + motor.sense_resistance.si
    play = axis.gear.backlash.si / 2.0
    stops = axis.stops
    buffer = (np.inf, 0.0, 0.0) if stops is None else (stops.high.si, stops.stiffness.si, stops.damping.si)
    p = np.array([
        axis.inertia.si, motor.rotor_inertia.si, axis.gear.stiffness.si / 2.0, axis.gear.damping.si / 2.0,
        play, resistance, motor.inductance.si, motor.torque_constant.si, model.supply.voltage.si,
        friction.bristle_stiffness.si, friction.bristle_damping.si, friction.viscous.si, friction.coulomb.si,
        friction.stiction.si, friction.stribeck_rate.si, friction.stribeck_exponent.si, RATIO,
        *buffer,
    ])  # fmt: skip
    y = np.zeros(9)
    y[3], y[6] = RATIO * play, -RATIO * play
    times = [start for start, _, _ in manoeuvre] + [seconds]
    found: list[Floats] = []
    for (start, *duty), end in zip(manoeuvre, times[1:], strict=True):
        samples = np.arange(round(start / sample_s) + 1, round(end / sample_s) + 1) * sample_s
        samples = np.minimum(samples, end)
        solved = solve_ivp(
            _motion, (start, end), y, method="DOP853", t_eval=samples, args=(p, np.array(duty)),
            rtol=1e-8, atol=1e-11, max_step=2e-3,
        )  # fmt: skip
        assert solved.success
        y = solved.y[:, -1]
        found.append(solved.y[1])
    return np.concatenate(found)
