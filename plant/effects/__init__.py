"""The effects a drive shows and the declared model lacks: one file each in this folder."""

from importlib import import_module
from pkgutil import iter_modules

from plant.effects.base import Effect

#: what an effect is made of, and no effect itself
SHARED = ("base", "dispatch", "evaluate", "rows", "signals", "targets")
#: names of the catalogue, in its order
CATALOGUE: tuple[str, ...] = (
    "stribeck_change",
    "presliding",
    "viscous_change",
    "coulomb_change",
    "friction_asymmetry",
    "position_friction",
    "load_friction",
    "friction_warmup",
    "preload_change",
    "gravity_imbalance",
    "gear_eccentricity",
    "gear_mesh",
    "damaged_tooth",
    "motor_cogging",
    "torque_ripple",
    "play",
    "backlash_loss",
    "shaft_compliance",
    "structural_mode",
    "encoder_eccentricity",
    "encoder_subdivision",
    "roller_ratio",
    "roller_slip",
    "adc_offset",
    "adc_gain",
    "pwm_deadband",
    "diode_braking",
    "supply_sag",
    "winding_heating",
    "magnet_weakening",
    "wind_torque",
    "cable_wrap",
    "brake_drag",
    "bearing_pass",
    "encoder_thermal_drift",
    "channel_delay",
    "clock_jitter",
    "sample_loss",
    "log_wrap",
    "command_disturbance",
    "unknown",
)
#: all effects: those of the catalogue, then every other file of this folder
NAMES: tuple[str, ...] = (
    *CATALOGUE,
    *sorted({m.name for m in iter_modules(__path__)} - {*CATALOGUE, *SHARED}),
)

REGISTRY: dict[str, Effect] = {name: import_module(f"{__name__}.{name}").EFFECT for name in NAMES}
