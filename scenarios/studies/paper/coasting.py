"""What an axis does after the effort is taken away: load, two rotors on their trains, the electrical model.

The paper computes what the motors still do from "the applied voltage and electrical model of the motor". A
bridge with freewheel diodes stops the axis within some samples of the log, and its trains swing meanwhile. So
a rigid mass will not do. The load turns against friction, and each rotor pushes its own flank through its
train (Table 1). The motor that is turned against its pull brakes through its diode.
"""

from dataclasses import dataclass

import numpy as np

from plant.parts import PlantModel
from scenarios.studies.paper.friction_map import FrictionFit
from scenarios.studies.paper.log import Array
from scenarios.studies.paper.scales import ARCSEC, CONTROL_PERIOD_S, COUNT_RATE, GEAR_RATIO, LOG_PERIOD_S

STEP_S = 0.25e-3
"""s: a tenth of what the fastest swing (rotor on its train, about 25 Hz) takes for one radian."""
HALVINGS = 40
"""Of the interval 0 to 1 of a duty: to 1e-12."""


@dataclass(frozen=True, kw_only=True)
class Drive:
    """Data sheets of one drive.

    torque_constant: N m/A. winding: ohm; switch: ohm, with the sense resistor. inductance: H. diode_drop: V,
    infinite without a diode. rotor: kg m2, of a rotor at the axis. stiffness: N m/rad, of one train.
    voltage: V, of the supply. split: share of the duty for the lagging motor.
    """

    torque_constant: float
    winding: float
    switch: float
    inductance: float
    diode_drop: float
    rotor: float
    stiffness: float
    voltage: float
    split: float


def drive(plant: PlantModel) -> Drive:
    """Return the data sheets of a plant's RA drive. Friction, inertia and damping of the trains are not in
    them."""
    axis = plant.axes.ra
    motor = axis.motor
    drops = [e.parameters["drop"].si for e in axis.effects if e.name == "diode_braking"]
    return Drive(
        torque_constant=motor.torque_constant.si,
        winding=motor.resistance.si,
        switch=motor.switch_resistance.si + motor.sense_resistance.si,
        inductance=motor.inductance.si,
        diode_drop=drops[0] if drops else float("inf"),
        rotor=motor.rotor_inertia.si * GEAR_RATIO**2,
        stiffness=axis.gear.stiffness.si / 2.0,
        voltage=plant.supply.voltage.si,
        split=plant.controller.counter_split.si,
    )


def current(sheet: Drive, duty: Array, emf: Array) -> tuple[Array, Array]:
    """Return what a motor's current tends to, A, below zero where none flows, and its resistance, ohm.

    duty: 0..1. emf: V, against the supply. While the switch is open the current runs down through winding and
    diode. Without a diode the paper's superposition holds.
    """
    if sheet.diode_drop == float("inf"):
        loop = np.full_like(emf, sheet.winding + sheet.switch)
        return (duty * sheet.voltage - np.maximum(emf, 0.0)) / loop, loop
    resistance = sheet.winding + duty * sheet.switch
    return (duty * (sheet.voltage + sheet.diode_drop) - sheet.diode_drop - emf) / resistance, resistance


def held_duty(sheet: Drive, torque: Array, w: Array) -> Array:
    """Return the duty at which both motors together hold a torque, N m at the axis, at a speed, rad/s."""
    emf = sheet.torque_constant * GEAR_RATIO
    low, high = np.zeros_like(w), np.ones_like(w)
    for _ in range(HALVINGS):
        duty = 0.5 * (low + high)
        pull, brake = current(sheet, duty, emf * w)[0], current(sheet, sheet.split * duty, -emf * w)[0]
        enough = np.maximum(0.0, pull) - np.maximum(0.0, brake) >= torque / emf
        low, high = np.where(enough, low, duty), np.where(enough, duty, high)
    return high


@dataclass(frozen=True, kw_only=True)
class Coasting:
    """inertia: of the whole axis with rotors, kg m2. damping: of one train, N m s/rad. late_s: from the
    command to the moment at which the duties fall, s."""

    inertia: float
    damping: float
    late_s: float


def coast(sheet: Drive, friction: FrictionFit, axis: Coasting, setpoints: Array, samples: int) -> Array:
    """Return the counts of 5 ms, shape (runs, samples), that the log has every 10 ms after "effort 0".

    setpoints: rad/s > 0, one steady state for each run.
    """
    damping, late_s = axis.damping, axis.late_s
    k, n, load = sheet.torque_constant, GEAR_RATIO, axis.inertia - 2.0 * sheet.rotor
    emf = k * n
    fade = -STEP_S / sheet.inductance
    w = np.array(setpoints, dtype=np.float64)
    lead_w, lag_w = w.copy(), w.copy()
    duty = held_duty(sheet, friction.torque(w), w)
    lead_i = np.maximum(0.0, current(sheet, duty, emf * w)[0])
    lag_i = np.maximum(0.0, current(sheet, sheet.split * duty, -emf * w)[0])
    lead_x, lag_x = emf * lead_i / sheet.stiffness, -emf * lag_i / sheet.stiffness
    per_log, per_tick = round(LOG_PERIOD_S / STEP_S), round(CONTROL_PERIOD_S / STEP_S)
    travelled = np.zeros((samples * per_log, w.size))
    for step in range(samples * per_log):
        on = min(1.0, max(0.0, late_s / STEP_S - step))
        lead_goal, lead_r = current(sheet, on * duty, emf * lead_w)
        lag_goal, lag_r = current(sheet, on * sheet.split * duty, -emf * lag_w)
        lead_i = np.maximum(0.0, lead_goal + (lead_i - lead_goal) * np.exp(lead_r * fade))
        lag_i = np.maximum(0.0, lag_goal + (lag_i - lag_goal) * np.exp(lag_r * fade))
        push = np.maximum(0.0, sheet.stiffness * lead_x + damping * (lead_w - w))
        pull = np.maximum(0.0, -sheet.stiffness * lag_x - damping * (lag_w - w))
        before = w
        w = w + STEP_S * (push - pull - friction.torque(np.maximum(w, 1e-9))) / load
        w = np.where((w < 0.0) & (before >= 0.0), 0.0, w)
        lead_w = lead_w + STEP_S * (emf * lead_i - push) / sheet.rotor
        lag_w = lag_w + STEP_S * (pull - emf * lag_i) / sheet.rotor
        lead_x = lead_x + STEP_S * (lead_w - w)
        lag_x = lag_x + STEP_S * (lag_w - w)
        travelled[step] = w * STEP_S
    ticks = travelled.reshape(samples, per_log, w.size)[:, -per_tick:].sum(axis=1)
    return np.asarray(ticks.T / CONTROL_PERIOD_S / ARCSEC / COUNT_RATE, dtype=np.float64)
