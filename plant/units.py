"""Units of plant files: name -> (base unit, factor). A number may use any unit with the field's base unit."""

from math import pi

from plant.gears import RATIO

TURN = 2.0 * pi
ARCSEC_PER_TURN = 1296000.0
ARCSEC = TURN / ARCSEC_PER_TURN
"""rad"""

_OTHERS: dict[str, dict[str, float]] = {
    "1": {"%": 0.01, "ppm": 1e-6},
    "kg m2": {"N m s2": 1.0, "N mm s2": 1e-3},
    # a torque at the motor shaft, quoted for the axis (hardware.md 2.3, reading C)
    "N m": {"N mm": 1e-3, "N mm motor": 1e-3 * RATIO},
    "N m/rad": {"N mm/rad": 1e-3},
    "rad": {"deg": pi / 180.0, "arcsec": ARCSEC, "deg motor": pi / 180.0 / RATIO},
    "rad/s": {"deg/s": pi / 180.0, "arcsec/s": ARCSEC},
    "rad/s2": {"arcsec/s2": ARCSEC},
    "rad/(N m)": {"arcsec/(N m)": ARCSEC},
    "rad/K": {"arcsec/K": ARCSEC},
    "V": {"mV": 1e-3},
    "A": {"mA": 1e-3},
    "ohm": {"mohm": 1e-3},
    "H": {"mH": 1e-3},
    "N m/A": {"V s/rad": 1.0},
    "s": {"ms": 1e-3, "us": 1e-6},
    "Hz": {"kHz": 1e3},
    "K/s": {"K/h": 1.0 / 3600.0},
    "m": {"mm": 1e-3, "um": 1e-6},
    "m/turn": {"mm/turn": 1e-3},
}
"""Base unit to the others of its quantity, and their sizes in it."""
_ALONE = (
    "N m s/rad",
    "K/W",
    "degC",
    "counts",
    "counts/turn",
    "bit",
    "steps",
    "half steps/turn",
    "steps/count",
)
"""Base units that nothing else is written in."""
UNITS: dict[str, tuple[str, float]] = {
    unit: (base, size)
    for base in (*_OTHERS, *_ALONE)
    for unit, size in ({base: 1.0} | _OTHERS.get(base, {})).items()
}


def factor(unit: str, base: str) -> float:
    """Return what makes a number in `unit` one in `base`; KeyError when that makes no sense."""
    its_base, scale = UNITS[unit]
    if its_base != UNITS[base][0]:
        raise KeyError(unit)
    return scale / UNITS[base][1]


def to_si(value: float, unit: str) -> float:
    """Return the value in the base unit of `unit`."""
    return value * UNITS[unit][1]
