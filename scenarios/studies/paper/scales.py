"""What the authors knew: scales of log and axis, Table 2, the drive. All from the paper unless told."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from plant.parts import PlantModel
from plant.units import ARCSEC as ARCSEC
from plant.units import ARCSEC_PER_TURN

Array = NDArray[np.float64]
ENCODER_ARCSEC = ARCSEC_PER_TURN / 112_896_000.0
"""arcsec per incremental count: 4.608e6 counts x 735/30 (paper 2.2, 3.2)."""
CONTROL_PERIOD_S = 0.005  # Sampling time of the controller (paper 3.3).
LOG_PERIOD_S = 0.010  # Sampling time of the log (paper 3.4).
COUNT_RATE = ENCODER_ARCSEC / CONTROL_PERIOD_S  # arcsec/s per count in 5 ms: the velocity quantum, 2.296.
ADC_A_PER_COUNT = 0.0061  # A per ADC count: 0.1 ohm, gain 8, 10 bit, 5 V (ASSUMPTION, hardware.md 2.3).
EFFORT_SCALE = 3000  # The effort's unit is 1/3000 of the supply (log format).
GEAR_RATIO = 113 / 27 * 123 / 21 * 250 / 17  # Motor turns per axis turn (paper 2.2).
TABLE_2 = {
    "low": {"viscous": 6700.0, "coulomb": 229.0, "stiction": 621.0, "stribeck_rate": 4e-4},
    "high": {"viscous": 11300.0, "coulomb": 217.0, "stiction": 1490.0, "stribeck_rate": 7e-4},
}
"""Table 2, about the RA axis: N m s/rad, N m, N m, rad/s."""
INERTIA = 1760.0  # kg m2: 1.76e6 N mm s2 from the run-down test.


@dataclass(frozen=True, kw_only=True)
class Drive:
    """Data sheets of one drive: what the authors knew of it.

    torque_constant: N m/A. winding, switch: ohm; the switch is in the loop while it is closed. inductance: H.
    diode_drop: V of the freewheel diodes; None: the paper's superposition of mean voltages. rotor: kg m2, of
    a rotor at the axis. stiffness: N m/rad, of one train. voltage: V, of the supply. split: share of the duty
    for the lagging motor. ripple: V / (2 L f), A, V from the diode's drop to the supply.
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
    ripple: float

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
    """Return the data sheets of a plant's RA drive, without friction, inertia and damping of the trains."""
    axis, controller = plant.axes.ra, plant.controller
    motor = axis.motor
    drop = motor.diode_drop.si if motor.diode_drop else None
    swing = plant.supply.voltage.si + (drop or 0.0)
    return Drive(
        torque_constant=motor.torque_constant.si,
        winding=motor.resistance.si,
        switch=motor.loop - motor.resistance.si,
        inductance=motor.inductance.si,
        diode_drop=drop,
        rotor=motor.rotor_inertia.si * GEAR_RATIO**2,
        stiffness=axis.gear.stiffness.si / 2.0,
        voltage=plant.supply.voltage.si,
        split=controller.counter_split.si,
        ripple=swing / (2.0 * motor.inductance.si * controller.pwm_frequency.si),
    )
