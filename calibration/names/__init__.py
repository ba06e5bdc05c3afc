"""Names that a drive's log may earn: one file per name, saying where it can be seen, its columns, bounds and
signs, its twins, and the experiment that separates them."""

from importlib import import_module

from calibration.names.name import Name

#: looked for in a balance of forces and in the difference of two sensors of any drive
FILES: tuple[str, ...] = (
    "bearing_pass",
    "brake_drag",
    "channel_delay",
    "command_disturbance",
    "coulomb_change",
    "encoder_eccentricity",
    "encoder_subdivision",
    "encoder_thermal_drift",
    "friction_asymmetry",
    "friction_warmup",
    "gear_eccentricity",
    "gear_mesh",
    "gravity_imbalance",
    "load_friction",
    "motor_cogging",
    "play",
    "position_friction",
    "preload_change",
    "presliding",
    "roller_slip",
    "shaft_compliance",
    "stribeck_change",
    "structural_mode",
    "supply_sag",
    "torque_ripple",
    "viscous_change",
)

NAMES: dict[str, Name] = {n: import_module(f"{__name__}.{n}").NAME for n in FILES}
