"""What there is to point at: bright stars, Messier's objects, bright ones of the NGC, and one's own."""

import csv
import math
import os
from functools import cache
from pathlib import Path
from typing import NamedTuple

import erfa
import numpy as np

from host.sky.angles import parse_declination, parse_right_ascension
from host.sky.apparent import terrestrial
from host.sky.catalogue import STARS, Star
from host.sky.observed import Clock, Observed, observe
from host.sky.site import Site

VARIABLE = "SCHMIDT_CATALOGUE"
"""The path of a list of one's own: columns name, ra, dec (ICRS). All of it is on the chart."""
_EARTH_AU = 6378.137 / 149597870.7
"""Equatorial radius (WGS84) in astronomical units (IAU 2012)."""


class Listed(NamedTuple):
    """An object: its place, and how bright it is, if that is known."""

    star: Star
    magnitude: float | None
    stellar: bool = False


def read(path: Path, stellar: bool = False) -> list[Listed]:
    """A CSV: notes that begin with #, a head line, objects. Raises ValueError with file and line."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: cannot be read: {error}") from None
    notes = next((k for k, line in enumerate(lines) if not line.startswith("#")), 0)
    rows = csv.DictReader(lines[notes:])
    found = []
    for row in rows:
        try:
            star = Star(row["name"], parse_right_ascension(row["ra"]), parse_declination(row["dec"]))
            found.append(Listed(star, float(row["magnitude"]) if row.get("magnitude") else None, stellar))
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError(f"{path}: line {notes + rows.line_num}: {error}") from None
    return found


@cache
def listed() -> dict[str, Listed]:
    """All, by name. One's own come first; a star to align on has its exact place."""
    own, folder = os.environ.get(VARIABLE), Path(__file__).parent
    found = {each.star.name: each._replace(magnitude=None) for each in read(Path(own))} if own else {}
    found |= {name: Listed(star, None, True) for name, star in STARS.items() if name not in found}
    for each in (*read(folder / "stars.csv", stellar=True), *read(folder / "deepsky.csv")):
        name = each.star.name
        found[name] = found[name]._replace(magnitude=each.magnitude) if name in found else each
    return found


def moon(site: Site, clock: Clock, t_s: float) -> tuple[Observed, float]:
    """Where the Moon stands, to an arcminute, and the lit share of its disc (ERFA's `moon98`, `epv00`)."""
    time = terrestrial(clock, t_s)
    place, sun = erfa.moon98(*time)["p"], -erfa.epv00(*time)[0]["p"]
    right_ascension, declination = erfa.c2s(place)
    seen = observe(Star("Moon", float(erfa.anp(right_ascension)), float(declination)), site, clock, t_s)
    low_rad = _EARTH_AU / float(np.linalg.norm(place)) * math.cos(seen.altitude_rad)
    lit = (1 - math.cos(float(erfa.sepp(place, sun)))) / 2
    return seen._replace(altitude_rad=seen.altitude_rad - low_rad), lit
