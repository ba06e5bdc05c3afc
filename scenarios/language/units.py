"""Values with units, as people write them in a scenario: one table, one parser."""

import math
import re
from typing import NamedTuple


class Unit(NamedTuple):
    """What a unit measures and its size in that quantity's base unit."""

    quantity: str
    factor: float


BASE = {
    "time": "s",
    "angle": "arcsec",
    "rate": "arcsec/s",
    "fraction": "1",
    "focus": "half steps",
    "pressure": "hPa",
    "temperature": "°C",
    "length": "m",
    "bitrate": "bit/s",
}
"""Base unit of every quantity: what `parse` returns."""

UNITS: dict[str, Unit] = {
    "ns": Unit("time", 1e-9),
    "us": Unit("time", 1e-6),
    "µs": Unit("time", 1e-6),
    "ms": Unit("time", 1e-3),
    "s": Unit("time", 1.0),
    "min": Unit("time", 60.0),
    "h": Unit("time", 3600.0),
    "mas": Unit("angle", 1e-3),
    "arcsec": Unit("angle", 1.0),
    "″": Unit("angle", 1.0),
    "arcmin": Unit("angle", 60.0),
    "deg": Unit("angle", 3600.0),
    "°": Unit("angle", 3600.0),
    "arcsec/s": Unit("rate", 1.0),
    "″/s": Unit("rate", 1.0),
    "arcmin/s": Unit("rate", 60.0),
    "deg/s": Unit("rate", 3600.0),
    "°/s": Unit("rate", 3600.0),
    "%": Unit("fraction", 0.01),
    "half steps": Unit("focus", 1.0),
    "half step": Unit("focus", 1.0),
    "um": Unit("focus", 1 / 6.25),  # 6.25 µm per half step (P11)
    "µm": Unit("focus", 1 / 6.25),
    "hPa": Unit("pressure", 1.0),
    "degC": Unit("temperature", 1.0),
    "°C": Unit("temperature", 1.0),
    "m": Unit("length", 1.0),
    "kbit/s": Unit("bitrate", 1e3),
    "Mbit/s": Unit("bitrate", 1e6),
}

LIMITS = {
    "time": 1e7,
    "angle": 1e10,
    "rate": 1e10,
    "fraction": 1e6,
    "focus": 1e6,
    "pressure": 1e4,
    "temperature": 1e3,
    "length": 1e4,
    "bitrate": 1e12,
}
"""Largest magnitude of every quantity, in its base unit: far beyond anything at a telescope (four
months, 7700 turns, 10 km), near enough that no sum of them overflows and nobody waits for it. ASSUMPTION."""

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
    if word is None:
        if quantity in ("fraction", "focus"):
            if abs(number) > LIMITS[quantity]:
                raise UnitError(f"{text!r} is too large; at most {LIMITS[quantity]:g}")
            return number
        raise UnitError(f"{text!r} has no unit; write it like {example(quantity)}")
    unit = UNITS.get(word)
    if unit is None or unit.quantity != quantity:
        raise UnitError(f"{text!r}: unit {word!r} does not fit; use one of {', '.join(units_of(quantity))}")
    value = number * unit.factor
    if abs(value) > LIMITS[quantity]:
        raise UnitError(f"{text!r} is too large; at most {LIMITS[quantity]:g} {BASE[quantity]}")
    return value


def unit_of(text: object) -> str:
    """The unit's word in a value that `parse` takes; "" for a plain number."""
    match = _FORM.match(str(text))
    return (match.group(2) or "") if match else ""


def units_of(quantity: str) -> list[str]:
    """The unit words of a quantity."""
    return [word for word, unit in UNITS.items() if unit.quantity == quantity]


def example(quantity: str) -> str:
    """A value of the quantity as one would write it."""
    words = units_of(quantity)
    return f"'10 {BASE[quantity] if BASE[quantity] in words else words[0]}'"
