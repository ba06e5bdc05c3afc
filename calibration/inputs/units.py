"""What a unit's name says: position units per turn."""

from math import pi

from plant.units import ARCSEC_PER_TURN

PER_TURN: dict[str, float] = {"rad": 2 * pi, "radian": 2 * pi, "mrad": 2000 * pi, "gon": 400.0}
PER_TURN |= {"arcmin": 21600.0, "arcsec": ARCSEC_PER_TURN}
PER_TURN |= dict.fromkeys(("deg", "degree", "°"), 360.0) | dict.fromkeys(("turn", "rev", "revolution"), 1.0)


def units_per_turn(unit: str) -> float | None:
    """Position units per turn of the part that the position belongs to; None for a length or for counts."""
    word = unit.strip().split()[-1].lower() if unit.strip() else ""
    return PER_TURN.get(word) or PER_TURN.get(word.removesuffix("s"))


def is_rate(unit: str) -> bool:
    """Whether a unit is one of a position per time."""
    word = unit.strip().lower()
    return word == "rpm" or word.removesuffix(".").endswith(("/s", "/min", " per s", " per min"))


def rad_per_unit(unit: str, per_s: bool) -> float | None:
    """rad (or rad/s) per unit; None for a unit that is none of an angle (or of an angle per s)."""
    word, slash, per = unit.partition("/")
    if per_s and not (slash and per.strip() == "s"):
        return None
    turn = units_per_turn(word if per_s else unit)
    return 2 * pi / turn if turn else None
