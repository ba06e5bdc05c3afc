"""Values with units, as people write them in a scenario: one table, one parser."""

import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import yaml


class Quantity(NamedTuple):
    """base: what `parse` returns it in. limit: largest magnitude, in the base unit. units: their sizes in it.

    Limits are far beyond anything at a telescope: four months, 7700 turns, 10 km. ASSUMPTION. They are near
    enough that no sum of them overflows and nobody waits for it.
    """

    base: str
    limit: float
    units: Mapping[str, float]


QUANTITIES = {
    name: Quantity(**row)
    for name, row in yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8")).items()
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
