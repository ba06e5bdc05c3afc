"""The emulator beside models of it: equation (6) with the same PI, and tuning rules (E9, E10).

The rules are for a PI on a first-order model with dead time. All are in O'Dwyer's Handbook of PI and PID
Controller Tuning Rules (the paper's ref. 15), under their authors:

- Ziegler and Nichols (1942), reaction curve.
- Chien, Hrones and Reswick (1952), servo, without and with 20 % overshoot.
- Cohen and Coon (1953), quarter decay ratio.
- Rivera, Morari and Skogestad (1986), improved PI, lambda = 1.7 L.
- Skogestad (2003), closed-loop time constant = dead time, the tightest that is advised.
- Astrom and Hagglund (2006), AMIGO, largest integral gain at a maximum sensitivity of 1.4 (also ref. 16).
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, log

import numpy as np

from plant.parts import PlantModel
from scenarios.studies.paper import scales
from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.experiments.identify import FirstOrder, identify
from scenarios.studies.paper.measures import Array
from scenarios.studies.paper.runs import STEP_TO
from scenarios.studies.paper.starts import Benches, Gains

RAMP_ARCSEC_S2 = 7200.0  # The firmware's acceleration limit, 2 deg/s2 (Table 1).


@dataclass(frozen=True, kw_only=True)
class LinearAxis:
    """The RA axis, reflected to the motor shaft: what equation (6) needs. SI units.

    drive: share of the effort that is left after the counter motor's, by superposition (paper 3.3).
    """

    torque_constant: float
    resistance: float
    inductance: float
    inertia: float
    viscous: float
    stiction: float
    voltage: float
    drive: float


def linear_axis(model: PlantModel) -> LinearAxis:
    """Return equation (6) for a plant's RA axis, without torsion and play, the rotors' inertia counted."""
    axis, motor = model.axes.ra, model.axes.ra.motor
    square = scales.GEAR_RATIO**2
    return LinearAxis(
        torque_constant=motor.torque_constant.si,
        resistance=motor.loop,
        inductance=motor.inductance.si,
        inertia=axis.inertia.si / square + 2.0 * motor.rotor_inertia.si,
        viscous=axis.friction.viscous.si / square + 2.0 * motor.drag.si,
        stiction=axis.friction.stiction.si / scales.GEAR_RATIO,
        voltage=model.supply.voltage.si,
        drive=1.0 - model.controller.counter_split.si,
    )


def simulate_loop(axis: LinearAxis, gains: Gains, pwm_steps: int, seconds: float) -> tuple[Array, Array]:
    """Return velocity (arcsec/s), effort (1/3000) of equation (6) in the loop of the paper's PI, from rest.

    The set point rises to STEP_TO as the firmware's does.
    One row per controller period, s. Steps of 0.1 ms; the effort acts Delta t / 2 late; the controller sees
    the mean velocity of its period, unquantised. At rest the stiction only holds: it never pushes back.
    """
    kp, ki = gains
    fine, dt = 50, scales.CONTROL_PERIOD_S / 50
    decay = float(np.exp(-axis.resistance * dt / axis.inductance))
    count = round(seconds / scales.CONTROL_PERIOD_S)
    out, efforts = np.zeros(count), np.zeros(count)
    to_axis = 1.0 / scales.GEAR_RATIO / scales.ARCSEC
    held = axis.stiction * axis.resistance / axis.torque_constant  # V that stiction takes away
    current = speed = effort = before = error = setpoint = 0.0
    for k in range(count):
        travelled = 0.0
        for j in range(fine):
            applied = before if j < fine // 2 else effort
            volt = applied / pwm_steps * axis.voltage * axis.drive - held
            goal = (volt - axis.torque_constant * speed) / axis.resistance
            current = goal + (current - goal) * decay
            speed += dt * (axis.torque_constant * current - axis.viscous * speed) / axis.inertia
            if speed <= 0.0 and volt <= 0.0:
                speed = current = 0.0
            travelled += speed * dt
        out[k] = travelled / scales.CONTROL_PERIOD_S * to_axis
        setpoint = min(STEP_TO, setpoint + RAMP_ARCSEC_S2 * scales.CONTROL_PERIOD_S)
        new = (setpoint - out[k]) / scales.COUNT_RATE
        before = effort
        effort = min(max(effort + kp * (new - error) + ki * new, -pwm_steps), pwm_steps)
        error = new
        efforts[k] = effort * scales.EFFORT_SCALE / pwm_steps
    return out, efforts


def _gains(proportional: float, integral_s: float) -> Gains:
    return proportional, proportional * scales.CONTROL_PERIOD_S / integral_s


def _cohen_coon(m: FirstOrder) -> Gains:
    r = m.dead_s / m.lag_s
    kc = (0.9 / r + 0.083) / m.gain
    return _gains(kc, m.dead_s * (3.33 + 0.31 * r) / (1.0 + 2.22 * r))


def _amigo(m: FirstOrder) -> Gains:
    dead, lag = m.dead_s, m.lag_s
    kc = (0.15 + (0.35 - dead * lag / (dead + lag) ** 2) * lag / dead) / m.gain
    return _gains(kc, 0.35 * dead + 13.0 * dead * lag**2 / (lag**2 + 12.0 * dead * lag + 7.0 * dead**2))


RULES: dict[str, Callable[[FirstOrder], Gains]] = {
    "Ziegler-Nichols": lambda m: _gains(0.9 * m.lag_s / (m.gain * m.dead_s), 3.33 * m.dead_s),
    "Chien 0 %": lambda m: _gains(0.35 * m.lag_s / (m.gain * m.dead_s), 1.17 * m.lag_s),
    "Chien 20 %": lambda m: _gains(0.6 * m.lag_s / (m.gain * m.dead_s), m.lag_s),
    "Cohen-Coon": _cohen_coon,
    "Rivera": lambda m: _gains(
        (2.0 * m.lag_s + m.dead_s) / (2.0 * m.gain * 1.7 * m.dead_s), m.lag_s + m.dead_s / 2.0
    ),
    "Skogestad": lambda m: _gains(m.lag_s / (2.0 * m.gain * m.dead_s), min(m.lag_s, 8.0 * m.dead_s)),
    "AMIGO": _amigo,
}


@row("E9")
def equation_6(benches: Benches) -> Figures:
    """Difference of the two responses from rest to 600 arcsec/s, and their settled efforts."""
    measured, plant = benches("low").closed_loop(STEP_TO, 3.0), benches.plants["low"]
    steps, seconds = round(plant.controller.pwm_steps.si), measured.t_s.size * scales.LOG_PERIOD_S
    modelled = simulate_loop(linear_axis(plant), benches.gains, steps, seconds)
    rate, effort = (x[1::2] for x in modelled)  # the log has every second tick
    late = slice(-rate.size // 3, None)
    return {
        "difference": float(np.sqrt(np.mean((measured.rate - rate) ** 2)) / STEP_TO * 100.0),
        "effort": (float(effort[late].mean()) / float(measured.effort[late].mean()) - 1.0) * 100.0,
    }


@row("E10", tuple((name, "factor") for name in RULES))
def tuning_rules(benches: Benches) -> Figures:
    """Factors between the plant file's gains and each rule's, for a model identified on the emulator."""
    model = identify(lambda: benches("low"))
    found = {name: factor(benches.gains, rule(model)) for name, rule in RULES.items()}
    nearest = sorted(found.values())
    return {
        "nearest": nearest[0],
        "second": nearest[1],
        "gain": model.gain,
        "lag": model.lag_s * 1e3,
        "dead time": model.dead_s * 1e3,
    } | found


def factor(one: Gains, other: Gains) -> float:
    """Return the larger of the two factors between gains, 1 or more."""
    return exp(max(abs(log(a / b)) for a, b in zip(one, other, strict=True)))
