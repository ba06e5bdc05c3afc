"""Values with units, as people write them in a scenario: one table, one parser."""

import math
import re
from collections.abc import Mapping
from typing import NamedTuple


class Quantity(NamedTuple):
    """base: what `parse` returns it in. limit: largest magnitude, in the base unit. units: their sizes in it.

    Limits are far beyond anything at a telescope: four months, 7700 turns, 10 km. ASSUMPTION. They are near
    enough that no sum of them overflows and nobody waits for it.
    """

    base: str
    limit: float
    units: Mapping[str, float]


_UM = 1 / 6.25
"""Half steps: 6.25 µm each (P11)."""
QUANTITIES = {
    "time": Quantity(
        "s", 1e7, {"ns": 1e-9, "us": 1e-6, "µs": 1e-6, "ms": 1e-3, "s": 1.0, "min": 60.0, "h": 3600.0}
    ),
    "angle": Quantity(
        "arcsec", 1e10, {"mas": 1e-3, "arcsec": 1.0, "″": 1.0, "arcmin": 60.0, "deg": 3600.0, "°": 3600.0}
    ),
    "rate": Quantity(
        "arcsec/s", 1e10, {"arcsec/s": 1.0, "″/s": 1.0, "arcmin/s": 60.0, "deg/s": 3600.0, "°/s": 3600.0}
    ),
    "fraction": Quantity("1", 1e6, {"%": 0.01}),
    "focus": Quantity("half steps", 1e6, {"half steps": 1.0, "half step": 1.0, "um": _UM, "µm": _UM}),
    "pressure": Quantity("hPa", 1e4, {"hPa": 1.0}),
    "temperature": Quantity("°C", 1e3, {"degC": 1.0, "°C": 1.0}),
    "length": Quantity("m", 1e4, {"m": 1.0}),
    "bitrate": Quantity("bit/s", 1e12, {"kbit/s": 1e3, "Mbit/s": 1e6}),
}
BASE = {name: quantity.base for name, quantity in QUANTITIES.items()}
_FORM = re.compile(r"^\s*([+\-−]?(?:\d+\.?\d*|\.\d+)(?:[eE][+\-]?\d+)?)\s*(\S.*?)?\s*$")


class UnitError(ValueError):
    """A value whose number or unit cannot be used; the message says which units would be right."""


def parse(text: object, quantity: str) -> float:
    """Read a value such as `120 s` or `10 arcsec` into the quantity's base unit.

    A plain number is accepted for `fraction` and `focus` only, where the unit is the number's own.
    """
    if isinstance(text, bool) or not isinstance(text, (str, int, float)):
        raise UnitError(f"{text!r} is not a value with a unit such as {example(quantity)}")
    match = _FORM.match(str(text))
    if match is None:
        raise UnitError(f"{text!r} is not a number with a unit such as {example(quantity)}")
    number = float(match.group(1).replace("−", "-"))
    if not math.isfinite(number):
        raise UnitError(f"{text!r} is too large")
    word = match.group(2)
    base, limit, units = QUANTITIES[quantity]
    if word is None and quantity not in ("fraction", "focus"):
        raise UnitError(f"{text!r} has no unit; write it like {example(quantity)}")
    if word is not None and word not in units:
        raise UnitError(f"{text!r}: unit {word!r} does not fit; use one of {', '.join(units)}")
    value = number if word is None else number * units[word]
    if abs(value) > limit:
        raise UnitError(f"{text!r} is too large; at most {limit:g}{'' if word is None else f' {base}'}")
    return value


def unit_of(text: object) -> str:
    """The unit's word in a value that `parse` takes; "" for a plain number."""
    match = _FORM.match(str(text))
    return (match.group(2) or "") if match else ""


def example(quantity: str) -> str:
    """A value of the quantity as one would write it."""
    base, _, units = QUANTITIES[quantity]
    return f"'10 {base if base in units else next(iter(units))}'"
