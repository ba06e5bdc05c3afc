"""Static dispatch over the effects: a kind is a number in a row, its formula is called directly.

Kinds count the terms of the registry in its order; a test compares the two."""

from plant.compiled import Floats, inner
from plant.effects import (
    adc_gain,
    adc_offset,
    backlash_loss,
    bearing_pass,
    brake_drag,
    cable_wrap,
    channel_delay,
    clock_jitter,
    command_disturbance,
    coulomb_change,
    damaged_tooth,
    diode_braking,
    encoder_eccentricity,
    encoder_subdivision,
    encoder_thermal_drift,
    friction_asymmetry,
    friction_warmup,
    gear_eccentricity,
    gear_mesh,
    gravity_imbalance,
    load_friction,
    log_wrap,
    magnet_weakening,
    motor_cogging,
    play,
    position_friction,
    preload_change,
    presliding,
    pwm_deadband,
    roller_ratio,
    roller_slip,
    sample_loss,
    shaft_compliance,
    stribeck_change,
    structural_mode,
    supply_sag,
    torque_ripple,
    unknown,
    viscous_change,
    wind_torque,
    winding_heating,
)


@inner
def value(kind: int, x: Floats, p: Floats) -> float:
    """Return the value of one term, in the unit of its hook; friction terms change `x` in place."""
    if kind == 0:
        return stribeck_change.formula(x, p)
    if kind == 1:
        return presliding.formula(x, p)
    if kind == 2:
        return viscous_change.formula(x, p)
    if kind == 3:
        return coulomb_change.formula(x, p)
    if kind == 4:
        return friction_asymmetry.formula(x, p)
    if kind == 5:
        return position_friction.formula(x, p)
    if kind == 6:
        return load_friction.formula(x, p)
    if kind == 7:
        return friction_warmup.formula(x, p)
    if kind == 8:
        return preload_change.formula(x, p)
    if kind == 9:
        return gravity_imbalance.formula(x, p)
    if kind == 10:
        return gear_eccentricity.formula(x, p)
    if kind == 11:
        return gear_eccentricity.twist(x, p)
    if kind == 12:
        return gear_mesh.formula(x, p)
    if kind == 13:
        return damaged_tooth.formula(x, p)
    if kind == 14:
        return motor_cogging.formula(x, p)
    if kind == 15:
        return torque_ripple.formula(x, p)
    if kind == 16:
        return play.formula(x, p)
    if kind == 17:
        return backlash_loss.formula(x, p)
    if kind == 18:
        return shaft_compliance.formula(x, p)
    if kind == 19:
        return structural_mode.formula(x, p)
    if kind == 20:
        return encoder_eccentricity.formula(x, p)
    if kind == 21:
        return encoder_subdivision.formula(x, p)
    if kind == 22:
        return roller_ratio.formula(x, p)
    if kind == 23:
        return roller_slip.formula(x, p)
    if kind == 24:
        return adc_offset.formula(x, p)
    if kind == 25:
        return adc_gain.formula(x, p)
    if kind == 26:
        return pwm_deadband.formula(x, p)
    if kind == 27:
        return diode_braking.formula(x, p)
    if kind == 28:
        return supply_sag.formula(x, p)
    if kind == 29:
        return winding_heating.formula(x, p)
    if kind == 30:
        return magnet_weakening.formula(x, p)
    if kind == 31:
        return wind_torque.formula(x, p)
    if kind == 32:
        return cable_wrap.formula(x, p)
    if kind == 33:
        return brake_drag.formula(x, p)
    if kind == 34:
        return bearing_pass.formula(x, p)
    if kind == 35:
        return encoder_thermal_drift.formula(x, p)
    if kind == 36:
        return channel_delay.formula(x, p)
    if kind == 37:
        return clock_jitter.formula(x, p)
    if kind == 38:
        return sample_loss.formula(x, p)
    if kind == 39:
        return log_wrap.formula(x, p)
    if kind == 40:
        return command_disturbance.formula(x, p)
    if kind == 41:
        return unknown.formula(x, p)
    return 0.0


@inner
def update(kind: int, x: Floats, p: Floats, dt: float) -> None:
    """Advance the memory of one term by `dt` seconds."""
    if kind == 7:
        friction_warmup.update(x, p, dt)
    elif kind == 16:
        play.update(x, p, dt)
    elif kind == 19:
        structural_mode.update(x, p, dt)
    elif kind == 23:
        roller_slip.update(x, p, dt)
    elif kind == 29:
        winding_heating.update(x, p, dt)
    elif kind == 31:
        wind_torque.update(x, p, dt)
    elif kind == 32:
        cable_wrap.update(x, p, dt)
    elif kind == 41:
        unknown.update(x, p, dt)
