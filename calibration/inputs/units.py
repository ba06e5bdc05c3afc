"""What a unit's name says: position units per turn."""

from __future__ import annotations

from math import pi

PER_TURN: dict[str, float] = {
    "rad": 2 * pi,
    "radian": 2 * pi,
    "mrad": 2000 * pi,
    "deg": 360.0,
    "degree": 360.0,
    "°": 360.0,
    "arcmin": 21600.0,
    "arcsec": 1296000.0,
    "gon": 400.0,
    "turn": 1.0,
    "rev": 1.0,
    "revolution": 1.0,
}


def units_per_turn(unit: str) -> float | None:
    """Position units per turn of the part that the position belongs to; None for a length or for counts."""
    word = unit.strip().split()[-1].lower() if unit.strip() else ""
    return PER_TURN.get(word) or PER_TURN.get(word.removesuffix("s"))
