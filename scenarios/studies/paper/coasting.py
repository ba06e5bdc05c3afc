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


@dataclass(frozen=True, kw_only=True)
class Drive:
    """Data sheets of one drive.

    torque_constant: N m/A. resistance: ohm. inductance: H. diode_drop: V, infinite without a diode.
    rotor: kg m2, of a rotor at the axis. stiffness: N m/rad, of one train. voltage: V, of the supply.
    split: share of the duty for the lagging motor.
    """

    torque_constant: float
    resistance: float
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
        resistance=motor.loop,
        inductance=motor.inductance.si,
        diode_drop=drops[0] if drops else float("inf"),
        rotor=motor.rotor_inertia.si * GEAR_RATIO**2,
        stiffness=axis.gear.stiffness.si / 2.0,
        voltage=plant.supply.voltage.si,
        split=plant.controller.counter_split.si,
    )


def opposing(emf: Array, drop: float) -> Array:
    """Return the voltage against the current, V: the EMF of a motor that turns as it pulls. For one that is
    turned against its pull: what drives current through the diode (negative)."""
    return np.asarray(np.where(emf >= 0.0, emf, np.minimum(0.0, emf + drop)), dtype=np.float64)


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
    decay = float(np.exp(-sheet.resistance * STEP_S / sheet.inductance))
    w = np.array(setpoints, dtype=np.float64)
    lead_w, lag_w = w.copy(), w.copy()
    # before: both duties in the ratio of the split, together what friction takes
    braking = np.maximum(0.0, emf * w - sheet.diode_drop) / sheet.resistance
    held = friction.torque(w) / emf + braking + emf * w / sheet.resistance
    duty_v = held * sheet.resistance / (1.0 - sheet.split)
    lead_i, lag_i = (duty_v - emf * w) / sheet.resistance, sheet.split * duty_v / sheet.resistance + braking
    lead_x, lag_x = emf * lead_i / sheet.stiffness, -emf * lag_i / sheet.stiffness
    per_log, per_tick = round(LOG_PERIOD_S / STEP_S), round(CONTROL_PERIOD_S / STEP_S)
    travelled = np.zeros((samples * per_log, w.size))
    for step in range(samples * per_log):
        on = min(1.0, max(0.0, late_s / STEP_S - step))
        lead_goal = (on * duty_v - opposing(emf * lead_w, sheet.diode_drop)) / sheet.resistance
        lag_goal = (on * sheet.split * duty_v - opposing(-emf * lag_w, sheet.diode_drop)) / sheet.resistance
        lead_i = np.maximum(0.0, lead_goal + (lead_i - lead_goal) * decay)
        lag_i = np.maximum(0.0, lag_goal + (lag_i - lag_goal) * decay)
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
