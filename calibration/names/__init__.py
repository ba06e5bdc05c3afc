"""Names that a drive's log may earn: one file per name, saying where it can be seen, its columns, bounds and
signs, its twins, and the experiment that separates them."""

from importlib import import_module
from pkgutil import iter_modules

from calibration.decide.experiments import TABLE
from calibration.names.name import Name

#: looked for in a balance of forces and in the difference of two sensors of any drive
ORDER: tuple[str, ...] = (
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

#: what names are made of, and no name itself
SHARED = ("columns", "lateness", "name", "onsets", "own", "scene", "sines", "unknown")
#: then every other file of this folder
FILES = (*ORDER, *sorted({m.name for m in iter_modules(__path__)} - {*ORDER, *SHARED}))

NAMES: dict[str, Name] = {n: import_module(f"{__name__}.{n}").NAME for n in FILES}
# `decide` is below this room: it is told what separates the names it has no line for
TABLE.update({n.name: n.experiment for n in NAMES.values() if n.own is not None})
