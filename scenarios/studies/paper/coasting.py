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

    torque_constant: N m/A. winding, switch: ohm; the switch is in the loop while it is closed. inductance: H.
    diode_drop: V of the freewheel diodes; None: the paper's superposition of mean voltages. rotor: kg m2, of
    a rotor at the axis. stiffness: N m/rad, of one train. voltage: V, of the supply. split: share of the duty
    for the lagging motor.
    """

    torque_constant: float
    winding: float
    switch: float
    inductance: float
    diode_drop: float | None
    rotor: float
    stiffness: float
    voltage: float
    split: float

    def tends(self, duty: Array, emf: Array) -> tuple[Array, Array]:
        """Return the mean current that a duty leads to, A, and the resistance it flows through, ohm.

        emf: V, negative for a motor that is turned against its pull. It drives current through the diode. No
        current flows where the result is negative.
        """
        if self.diode_drop is None:
            resistance = np.full_like(duty, self.winding + self.switch)
            driven = duty * self.voltage - np.maximum(0.0, emf)
        else:
            resistance = self.winding + duty * self.switch
            driven = duty * (self.voltage + self.diode_drop) - self.diode_drop - emf
        return np.asarray(driven / resistance), np.asarray(resistance)

    def steady(self, torque: Array, emf: Array) -> Array:
        """Return the leading motor's duty for a torque at a motor's shaft, N m, at a back-EMF, V."""
        low, high = np.zeros_like(emf), np.ones_like(emf)
        for _ in range(30):
            middle = 0.5 * (low + high)
            lead, lag = self.tends(middle, emf)[0], self.tends(self.split * middle, -emf)[0]
            less = self.torque_constant * (np.maximum(0.0, lead) - np.maximum(0.0, lag)) < torque
            low, high = np.where(less, middle, low), np.where(less, high, middle)
        return high


def drive(plant: PlantModel) -> Drive:
    """Return the data sheets of a plant's RA drive. Friction, inertia and damping of the trains are not in
    them."""
    axis = plant.axes.ra
    motor = axis.motor
    return Drive(
        torque_constant=motor.torque_constant.si,
        winding=motor.resistance.si,
        switch=motor.loop - motor.resistance.si,
        inductance=motor.inductance.si,
        diode_drop=motor.diode_drop.si if motor.diode_drop else None,
        rotor=motor.rotor_inertia.si * GEAR_RATIO**2,
        stiffness=axis.gear.stiffness.si / 2.0,
        voltage=plant.supply.voltage.si,
        split=plant.controller.counter_split.si,
    )


@dataclass(frozen=True, kw_only=True)
class Coasting:
    """inertia: of the whole axis with rotors, kg m2. damping: of one train, N m s/rad. late_s: from the
    command to the moment at which the duties fall, s."""

    inertia: float
    damping: float
    late_s: float


def settled(sheet: Drive, current: Array, duty: Array, emf: Array) -> Array:
    """Return a motor's current a step later, A."""
    goal, resistance = sheet.tends(duty, emf)
    return np.maximum(0.0, goal + (current - goal) * np.exp(-resistance * STEP_S / sheet.inductance))


def coast(sheet: Drive, friction: FrictionFit, axis: Coasting, setpoints: Array, samples: int) -> Array:
    """Return the counts of 5 ms, shape (runs, samples), that the log has every 10 ms after "effort 0".

    setpoints: rad/s > 0, one steady state for each run.
    """
    damping, late_s = axis.damping, axis.late_s
    k, n, load = sheet.torque_constant, GEAR_RATIO, axis.inertia - 2.0 * sheet.rotor
    emf = k * n
    w = np.array(setpoints, dtype=np.float64)
    lead_w, lag_w = w.copy(), w.copy()
    # before: both duties in the ratio of the split, together what friction takes
    duty = sheet.steady(friction.torque(w) / n, emf * w)
    lead_i = np.maximum(0.0, sheet.tends(duty, emf * w)[0])
    lag_i = np.maximum(0.0, sheet.tends(sheet.split * duty, -emf * w)[0])
    lead_x, lag_x = emf * lead_i / sheet.stiffness, -emf * lag_i / sheet.stiffness
    per_log, per_tick = round(LOG_PERIOD_S / STEP_S), round(CONTROL_PERIOD_S / STEP_S)
    travelled = np.zeros((samples * per_log, w.size))
    for step in range(samples * per_log):
        on = min(1.0, max(0.0, late_s / STEP_S - step))
        lead_i = settled(sheet, lead_i, on * duty, emf * lead_w)
        lag_i = settled(sheet, lag_i, on * sheet.split * duty, -emf * lag_w)
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
