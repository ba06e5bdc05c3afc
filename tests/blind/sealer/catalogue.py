"""The catalogue's names, who draws each, and which twins a manoeuvre may leave."""

from collections.abc import Callable

import numpy as np

from tests.blind.sealer import effects_friction as f
from tests.blind.sealer import effects_motor as m
from tests.blind.sealer import effects_sensor as s
from tests.blind.sealer import effects_torque as t
from tests.blind.sealer import outside as o
from tests.blind.sealer.draw import Drive
from tests.blind.sealer.drawn import Drawn

Draw = Callable[[np.random.Generator, Drive, float, float], Drawn]

EFFECTS: tuple[Draw, ...] = (
    f.stribeck_change, f.presliding, f.viscous_change, f.coulomb_change, f.friction_asymmetry,
    f.position_friction, f.load_friction, f.friction_warmup, f.preload_change, t.gravity_imbalance,
    t.gear_eccentricity, t.gear_mesh, t.damaged_tooth, m.motor_cogging, m.torque_ripple, s.play,
    t.backlash_loss,
    t.shaft_compliance, t.structural_mode, s.encoder_eccentricity, s.encoder_subdivision, s.roller_ratio,
    s.roller_slip, m.adc_offset, m.adc_gain, m.pwm_deadband, m.diode_braking, m.supply_sag,
    m.winding_heating, m.magnet_weakening, t.wind_torque, t.cable_wrap, f.brake_drag, t.bearing_pass,
    s.encoder_thermal_drift, s.channel_delay, s.clock_jitter, s.sample_loss, s.log_wrap,
    m.command_disturbance,
)  # fmt: skip
BY_NAME: dict[str, Draw] = {draw.__name__: draw for draw in EFFECTS}
OUTSIDE: dict[str, Draw] = {draw.__name__: draw for draw in o.OUTSIDE}

# Names that one rate in one direction (manoeuvre "mono") cannot separate.
MONO_CLASS: dict[str, tuple[str, ...]] = {
    "motor_cogging": ("motor_cogging", "torque_ripple"),
    "torque_ripple": ("motor_cogging", "torque_ripple"),
    "position_friction": ("position_friction", "gravity_imbalance", "cable_wrap"),
    "gravity_imbalance": ("position_friction", "gravity_imbalance", "cable_wrap"),
}

# Two at once: twenty pairs that look alike, twenty that do not.
CONFUSABLE: tuple[tuple[str, str], ...] = (
    ("motor_cogging", "torque_ripple"), ("gear_eccentricity", "gear_mesh"), ("gear_mesh", "bearing_pass"),
    ("gravity_imbalance", "cable_wrap"), ("gravity_imbalance", "position_friction"),
    ("viscous_change", "friction_asymmetry"), ("coulomb_change", "friction_asymmetry"),
    ("friction_asymmetry", "adc_offset"), ("adc_offset", "adc_gain"), ("adc_offset", "pwm_deadband"),
    ("supply_sag", "pwm_deadband"), ("winding_heating", "magnet_weakening"),
    ("friction_warmup", "winding_heating"), ("preload_change", "magnet_weakening"),
    ("encoder_eccentricity", "encoder_thermal_drift"), ("roller_ratio", "roller_slip"),
    ("damaged_tooth", "gear_eccentricity"), ("brake_drag", "friction_warmup"),
    ("structural_mode", "motor_cogging"), ("load_friction", "supply_sag"),
)  # fmt: skip
APART: tuple[tuple[str, str], ...] = (
    ("gravity_imbalance", "encoder_subdivision"), ("motor_cogging", "adc_offset"),
    ("gear_eccentricity", "roller_ratio"), ("position_friction", "clock_jitter"),
    ("coulomb_change", "encoder_eccentricity"), ("supply_sag", "gear_mesh"),
    ("viscous_change", "sample_loss"), ("brake_drag", "adc_gain"), ("shaft_compliance", "motor_cogging"),
    ("friction_warmup", "roller_slip"), ("diode_braking", "gravity_imbalance"),
    ("stribeck_change", "torque_ripple"), ("structural_mode", "roller_ratio"),
    ("cable_wrap", "pwm_deadband"), ("damaged_tooth", "encoder_thermal_drift"),
    ("bearing_pass", "winding_heating"), ("preload_change", "encoder_subdivision"),
    ("friction_asymmetry", "command_disturbance"), ("magnet_weakening", "gear_mesh"),
    ("wind_torque", "adc_offset"),
)  # fmt: skip
