"""The paper's linear model: equation (6) and its PI loop."""

from dataclasses import dataclass

import numpy as np

from plant.parts import PlantModel
from scenarios.studies.paper import scales
from scenarios.studies.paper.measures import Array, Log
from scenarios.studies.paper.runs import STEP_TO
from scenarios.studies.paper.starts import Benches

RAMP_ARCSEC_S2 = 7200.0
"""The firmware's acceleration limit, 2 deg/s2 (Table 1)."""


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


def beside(benches: Benches, log: Log) -> tuple[Array, Array, Array]:
    """Return what `simulate_loop` makes of a bench's low preload for as long as its log of a step."""
    plant = benches.plants["low"]
    steps, seconds = round(plant.controller.pwm_steps.si), log.t_s.size * scales.LOG_PERIOD_S
    return simulate_loop(linear_axis(plant), benches.gains, steps, STEP_TO, seconds, RAMP_ARCSEC_S2)


def simulate_loop(
    axis: LinearAxis,
    gains: tuple[float, float],
    pwm_steps: int,
    arcsec_s: float,
    seconds: float,
    ramp_arcsec_s2: float,
) -> tuple[Array, Array, Array]:
    """Return (t, velocity in arcsec/s, effort in 1/3000) of equation (6) in the loop of the paper's PI, from
    rest.

    gains: Kp, Ki in PWM steps per count. The set point rises with `ramp_arcsec_s2`, as the firmware's does.
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
        setpoint = min(arcsec_s, setpoint + ramp_arcsec_s2 * scales.CONTROL_PERIOD_S)
        new = (setpoint - out[k]) / scales.COUNT_RATE
        before = effort
        effort = min(max(effort + kp * (new - error) + ki * new, -pwm_steps), pwm_steps)
        error = new
        efforts[k] = effort * scales.EFFORT_SCALE / pwm_steps
    times: Array = (np.arange(count, dtype=np.float64) + 1.0) * scales.CONTROL_PERIOD_S
    return times, out, efforts
