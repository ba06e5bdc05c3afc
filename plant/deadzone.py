"""The duty that a motor needs before its current flows on, and the bias that lifts both motors above it."""

from plant.parts import Motor, PlantModel

DEAD_BAND = 0.01
"""Share of a pulse that a driver may swallow: the default of the effect `pwm_deadband`."""
MARGIN = 1.2
"""Of the bias over what is lost: the drop of a diode and the rest of it are known to 15 %. ASSUMPTION."""


def dead_zone(model: PlantModel, motor: Motor) -> float:
    """Return the duty below which the current dies in every PWM period, 0..1, at rest; 0 without diodes.

    The mean of a continuous current, (D (V + d) - d) / R, is half its rise there, D V / (2 L f).
    """
    if motor.diode_drop is None:
        return 0.0
    volts, drop = model.supply.voltage.si, motor.diode_drop.si
    ripple = motor.resistance.si / (2.0 * motor.inductance.si * model.controller.pwm_frequency.si)
    return drop / (volts + drop - ripple * volts)


def bias_steps(model: PlantModel, motor: Motor) -> int:
    """Return the PWM steps that both motors always get with the fine firmware: dead zone and dead band, and
    a fifth. The lagging motor then conducts and holds its teeth."""
    return round(MARGIN * (dead_zone(model, motor) + DEAD_BAND) * model.controller.pwm_steps.si)
