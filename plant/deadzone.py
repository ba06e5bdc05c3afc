"""Small duties: the dead zone of a power stage, the bias above it, and the torque of a PWM step beyond."""

from plant.gears import RATIO
from plant.parts import Motor, PlantModel

DEAD_BAND = 0.01
"""Share of a pulse that a driver may swallow: the default of the effect `pwm_deadband`."""
MARGIN = 1.2
"""Of the bias over what is lost: the drop of a diode and the rest of it are known to 15 %. ASSUMPTION."""


def drop_v(motor: Motor) -> float:
    """Return the drop of the freewheel diodes, V; 0 without a power stage."""
    return motor.diode_drop.si if motor.diode_drop else 0.0


def ohms(motor: Motor) -> float:
    """Return what a small duty's current flows through, ohm: with a power stage it freewheels nearly all the
    time, without switch and sense resistor."""
    return motor.resistance.si if motor.diode_drop else motor.loop


def step_amperes(model: PlantModel, motor: Motor) -> float:
    """Return the current of one PWM step more, A, at rest and beyond the dead zone."""
    return (model.supply.voltage.si + drop_v(motor)) / ohms(motor) / model.controller.pwm_steps.si


def step_torque(model: PlantModel, motor: Motor) -> float:
    """Return one motor's torque of a PWM step more, N m at the axis."""
    return step_amperes(model, motor) * motor.torque_constant.si * RATIO


def dead_zone(model: PlantModel, motor: Motor) -> float:
    """Return the duty below which the current dies in every PWM period, 0..1, at rest; 0 without diodes.

    The mean of a continuous current, (D (V + d) - d) / R, is half its rise there, D V / (2 L f).
    """
    volts, drop = model.supply.voltage.si, drop_v(motor)
    ripple = motor.resistance.si / (2.0 * motor.inductance.si * model.controller.pwm_frequency.si)
    below = volts + drop - ripple * volts
    if below <= drop:
        raise ValueError("the current dies at every duty: a larger inductance or PWM frequency is needed")
    return drop / below


def bias_steps(model: PlantModel, motor: Motor) -> int:
    """Return the PWM steps that both motors always get with the fine firmware: dead zone and dead band, and
    a fifth. The lagging motor then conducts and holds its teeth."""
    return round(MARGIN * (dead_zone(model, motor) + DEAD_BAND) * model.controller.pwm_steps.si)
