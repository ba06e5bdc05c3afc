"""Units of plant files: name -> (base unit, factor). A number may use any unit with the field's base unit."""

from math import pi

from plant.gears import RATIO

TURN = 2.0 * pi
ARCSEC_PER_TURN = 1296000.0
ARCSEC = TURN / ARCSEC_PER_TURN
"""rad"""

UNITS: dict[str, tuple[str, float]] = {
    "1": ("1", 1.0),
    "%": ("1", 0.01),
    "ppm": ("1", 1e-6),
    "kg m2": ("kg m2", 1.0),
    "N m s2": ("kg m2", 1.0),
    "N mm s2": ("kg m2", 1e-3),
    "N m": ("N m", 1.0),
    "N mm": ("N m", 1e-3),
    # a torque at the motor shaft, quoted for the axis (hardware.md 2.3, reading C)
    "N mm motor": ("N m", 1e-3 * RATIO),
    "N m/rad": ("N m/rad", 1.0),
    "N mm/rad": ("N m/rad", 1e-3),
    "N m s/rad": ("N m s/rad", 1.0),
    "rad": ("rad", 1.0),
    "deg": ("rad", pi / 180.0),
    "arcsec": ("rad", ARCSEC),
    "deg motor": ("rad", pi / 180.0 / RATIO),
    "rad/s": ("rad/s", 1.0),
    "deg/s": ("rad/s", pi / 180.0),
    "arcsec/s": ("rad/s", ARCSEC),
    "rad/s2": ("rad/s2", 1.0),
    "arcsec/s2": ("rad/s2", ARCSEC),
    "arcsec/(N m)": ("rad/(N m)", ARCSEC),
    "rad/(N m)": ("rad/(N m)", 1.0),
    "arcsec/K": ("rad/K", ARCSEC),
    "rad/K": ("rad/K", 1.0),
    "V": ("V", 1.0),
    "mV": ("V", 1e-3),
    "A": ("A", 1.0),
    "mA": ("A", 1e-3),
    "ohm": ("ohm", 1.0),
    "mohm": ("ohm", 1e-3),
    "H": ("H", 1.0),
    "mH": ("H", 1e-3),
    "N m/A": ("N m/A", 1.0),
    "V s/rad": ("N m/A", 1.0),
    "s": ("s", 1.0),
    "ms": ("s", 1e-3),
    "us": ("s", 1e-6),
    "Hz": ("Hz", 1.0),
    "kHz": ("Hz", 1e3),
    "K/W": ("K/W", 1.0),
    "degC": ("degC", 1.0),
    "K/s": ("K/s", 1.0),
    "K/h": ("K/s", 1.0 / 3600.0),
    "counts": ("counts", 1.0),
    "counts/turn": ("counts/turn", 1.0),
    "bit": ("bit", 1.0),
    "steps": ("steps", 1.0),
    "half steps/turn": ("half steps/turn", 1.0),
    "mm": ("m", 1e-3),
    "um": ("m", 1e-6),
    "m": ("m", 1.0),
    "mm/turn": ("m/turn", 1e-3),
    "m/turn": ("m/turn", 1.0),
    "steps/count": ("steps/count", 1.0),
}


def factor(unit: str, base: str) -> float:
    """Return what a number in `unit` is multiplied with to be in `base`; KeyError when that makes no
    sense.
    """
    its_base, scale = UNITS[unit]
    if its_base != UNITS[base][0]:
        raise KeyError(unit)
    return scale / UNITS[base][1]


def to_si(value: float, unit: str) -> float:
    """Return the value in the base unit of `unit`."""
    return value * UNITS[unit][1]
