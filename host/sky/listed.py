"""What there is to point at: bright stars, Messier's objects, bright ones of the NGC, and one's own."""

import csv
import math
import os
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import NamedTuple

import erfa
import numpy as np

from host.logs.files import reason
from host.sky.angles import parse_declination, parse_right_ascension
from host.sky.catalogue import STARS, Star
from host.sky.observed import Clock, Observed, observe, terrestrial
from host.sky.site import Site

FAINTEST_NGC = 9.0
"""Visual magnitude to which the NGC is listed. ASSUMPTION: a few hundred objects, what binoculars show."""
VARIABLE = "SCHMIDT_CATALOGUE"
"""The path of a list of one's own: columns name, ra, dec (ICRS). All of it is on the chart."""
_FAINTEST = 40.0
"""Magnitude, either way. ASSUMPTION: the Sun has -27, the faintest that was ever seen 32."""
_LONGEST = 50_000_000
"""Bytes of a list: a million objects. ASSUMPTION: more is no list, and fills the memory."""
_EARTH_AU = 6378.137 / 149597870.7
"""Equatorial radius (WGS84) in astronomical units (IAU 2012)."""


class Listed(NamedTuple):
    """An object: its place, and how bright it is, if that is known."""

    star: Star
    magnitude: float | None
    stellar: bool = False


def read(path: Path) -> list[Listed]:
    """A CSV: notes that begin with #, a head line, objects. Raises ValueError with file and line."""
    if path.exists() and not path.is_file():  # a pipe or a device may never end
        raise ValueError(f"{path}: no regular file; a list of objects is a CSV file")
    try:
        if path.stat().st_size > _LONGEST:
            raise ValueError(f"{path}: is longer than {_LONGEST} bytes")
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: cannot be read: {reason(error)}") from None
    notes = next((k for k, line in enumerate(lines) if not line.startswith("#")), 0)
    rows = csv.DictReader(lines[notes:], restval="")
    found = []
    try:
        if not {"name", "ra", "dec"} <= set(rows.fieldnames or ()):
            raise ValueError("the head line needs name, ra and dec")
        for row in rows:
            star = Star(row["name"], parse_right_ascension(row["ra"]), parse_declination(row["dec"]))
            found.append(Listed(star, _magnitude(row.get("magnitude", ""))))
    except (csv.Error, ValueError) as error:
        line = notes + max(rows.line_num + isinstance(error, csv.Error), 1)  # which ends before it is counted
        raise ValueError(f"{path}: line {line}: {error}") from None
    return found


def _magnitude(text: str) -> float | None:
    if not text:
        return None
    with suppress(ValueError):
        if abs(magnitude := float(text)) <= _FAINTEST:
            return magnitude
    raise ValueError(f"magnitude {text!r} is no number of at most {_FAINTEST:g}")


@cache
def listed() -> dict[str, Listed]:
    """All, by name. One's own come first; a star to align on has its exact place."""
    own = os.environ.get(VARIABLE)
    found = {each.star.name: each._replace(magnitude=None) for each in read(Path(own))} if own else {}
    found |= {name: Listed(star, None, True) for name, star in STARS.items() if name not in found}
    for each in (*bright_stars(), *deep_sky()):
        name = each.star.name
        found[name] = found[name]._replace(magnitude=each.magnitude) if name in found else each
    return found


def bright_stars() -> Iterator[Listed]:
    """The stars of PyEphem's list: Hipparcos places, names of the IAU; without proper motion."""
    from ephem.stars import db  # of the extra `consoles`, which alone lists what there is

    for line in db.splitlines():
        name, _, ra_h, dec_deg, magnitude = line.split(",")[:5]
        place = (float(text.split("|")[0]) for text in (ra_h, dec_deg))
        right_ascension, declination = (math.radians(k * x) for k, x in zip((15, 1), place, strict=True))
        yield Listed(Star(name, right_ascension, declination), float(magnitude), True)


def deep_sky() -> Iterator[Listed]:
    """Messier's objects and the bright ones of the NGC, from OpenNGC (PyOngc)."""
    from pyongc.ongc import listObjects

    for each in (*listObjects(catalog="M"), *listObjects(catalog="NGC", uptovmag=FAINTEST_NGC)):
        messier, _, _, common, _ = each.identifiers
        number = f"M {int(messier[1:])}" if messier else f"NGC {each.name[3:].lstrip('0')}"
        name = f"{number} ({common[0]})" if common else number
        place = each.rad_coords
        if place is not None:
            _, visual, *_ = each.magnitudes
            yield Listed(Star(name, float(place[0]), float(place[1])), visual)


def moon(site: Site, clock: Clock, t_s: float) -> tuple[Observed, float]:
    """Where the Moon stands, to an arcminute, and the lit share of its disc (ERFA's `moon98`, `epv00`)."""
    time = terrestrial(clock, t_s)
    place, sun = erfa.moon98(*time)["p"], -erfa.epv00(*time)[0]["p"]
    right_ascension, declination = erfa.c2s(place)
    seen = observe(Star("Moon", float(erfa.anp(right_ascension)), float(declination)), site, clock, t_s)
    low_rad = _EARTH_AU / float(np.linalg.norm(place)) * math.cos(seen.altitude_rad)
    lit = (1 - math.cos(float(erfa.sepp(place, sun)))) / 2
    return seen._replace(altitude_rad=seen.altitude_rad - low_rad), lit
