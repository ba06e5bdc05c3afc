"""Named bright stars: ICRS places at epoch J2000.0 with proper motions.

Source: the Hipparcos catalogue (ESA 1997; new reduction van Leeuwen 2007), places brought to epoch J2000.0
as SIMBAD prints them; V is its field H5. Only stars to align a telescope on; anything else is given by its
coordinates.
"""

import csv
import difflib
from dataclasses import dataclass
from pathlib import Path

from host.sky.angles import parse_declination, parse_right_ascension


@dataclass(frozen=True)
class Star:
    """A place in the ICRS at epoch J2000.0; proper motion in RA includes the cosine of declination."""

    name: str
    right_ascension_rad: float
    declination_rad: float
    pm_ra_mas_yr: float = 0.0
    pm_dec_mas_yr: float = 0.0
    parallax_mas: float = 0.0
    hipparcos: int | None = None
    magnitude: float | None = None


def _star(row: dict[str, str]) -> Star:
    place = parse_right_ascension(row["ra"]), parse_declination(row["dec"])
    motion = float(row["pm_ra"]), float(row["pm_dec"]), float(row["parallax"])
    return Star(row["name"], *place, *motion, int(row["hipparcos"]), float(row["v"]))


with Path(__file__).with_name("stars.csv").open(encoding="utf-8") as _file:
    STARS = {each["name"]: _star(each) for each in csv.DictReader(_file)}
"""By name; the table has mas/yr, mas/yr, mas."""


def star(name: str) -> Star:
    """Find a star by its name, in any case; an unknown name raises `ValueError` with the nearest one."""
    by_lower = {known.lower(): known for known in STARS}
    if name.lower() in by_lower:
        return STARS[by_lower[name.lower()]]
    near = difflib.get_close_matches(name.lower(), by_lower, n=1, cutoff=0.5)
    hint = f"; did you mean {by_lower[near[0]]}?" if near else "; give ra and dec instead"
    raise ValueError(f"no star called {name!r} in the catalogue{hint}")
