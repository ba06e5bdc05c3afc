"""Named bright stars: ICRS places at epoch J2000.0 with proper motions.

Source: the Hipparcos catalogue (ESA 1997; new reduction van Leeuwen 2007), places brought to epoch J2000.0
as SIMBAD prints them; V is its field H5. Only stars to align a telescope on; anything else is given by its
coordinates.
"""

import difflib
from dataclasses import dataclass

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


class UnknownTarget(ValueError):
    """A name that the catalogue does not hold."""


# Hipparcos number, name, right ascension, declination, proper motions and parallax (mas/yr, mas/yr, mas), V
_TABLE = """
677    Alpheratz   00:08:23.25988 +29:05:25.5520   137.46  -163.44  33.62   2.07
11767  Polaris     02:31:49.09456 +89:15:50.7923    44.48   -11.85   7.54   1.97
15863  Mirfak      03:24:19.37009 +49:51:40.2455    23.75   -26.23   6.44   1.79
21421  Aldebaran   04:35:55.23907 +16:30:33.4885    63.45  -188.94  48.94   0.87
24436  Rigel       05:14:32.27210 -08:12:05.8981     1.31     0.50   3.78   0.18
24608  Capella     05:16:41.35871 +45:59:52.7693    75.25  -426.89  76.20   0.08
25336  Bellatrix   05:25:07.86325 +06:20:58.9318    -8.11   -12.88  12.92   1.64
25428  Elnath      05:26:17.51312 +28:36:26.8262    22.76  -173.58  24.36   1.65
27989  Betelgeuse  05:55:10.30536 +07:24:25.4304    27.54    11.30   6.55   0.45
32349  Sirius      06:45:08.91728 -16:42:58.0171  -546.01 -1223.07 379.21  -1.44
36850  Castor      07:34:35.87319 +31:53:17.8160  -191.45  -145.19  64.12   1.58
37279  Procyon     07:39:18.11950 +05:13:29.9552  -714.59 -1036.80 284.56   0.40
37826  Pollux      07:45:18.94987 +28:01:34.3160  -626.55   -45.80  96.54   1.16
49669  Regulus     10:08:22.31099 +11:58:01.9516  -248.73     5.59  41.13   1.36
54061  Dubhe       11:03:43.67152 +61:45:03.7249  -134.11   -34.70  26.54   1.81
57632  Denebola    11:49:03.57834 +14:34:19.4090  -497.68  -114.67  90.91   2.14
62956  Alioth      12:54:01.74959 +55:57:35.3627   111.91    -8.24  39.51   1.76
65474  Spica       13:25:11.57937 -11:09:40.7501   -42.35   -30.67  13.06   0.98
69673  Arcturus    14:15:39.67207 +19:10:56.6730 -1093.39 -2000.06  88.83  -0.05
80763  Antares     16:29:24.45970 -26:25:55.2094   -12.11   -23.30   5.89   1.06
91262  Vega        18:36:56.33635 +38:47:01.2802   200.94   286.23 130.23   0.03
97649  Altair      19:50:46.99855 +08:52:05.9563   536.23   385.29 194.95   0.76
102098 Deneb       20:41:25.91514 +45:16:49.2197     2.01     1.85   2.31   1.25
113368 Fomalhaut   22:57:39.04625 -29:37:20.0533   328.95  -164.67 129.81   1.17
"""


def _star(line: str) -> Star:
    number, name, ra, dec, pm_ra, pm_dec, parallax, magnitude = line.split()
    place = parse_right_ascension(ra), parse_declination(dec)
    motion = float(pm_ra), float(pm_dec), float(parallax)
    return Star(name, *place, *motion, int(number), float(magnitude))


STARS: dict[str, Star] = {star.name: star for star in map(_star, _TABLE.strip().splitlines())}


def star(name: str) -> Star:
    """Find a star by its name, in any case; an unknown name raises `UnknownTarget` with the nearest one."""
    by_lower = {known.lower(): known for known in STARS}
    if name.lower() in by_lower:
        return STARS[by_lower[name.lower()]]
    near = difflib.get_close_matches(name.lower(), by_lower, n=1, cutoff=0.5)
    hint = f"; did you mean {by_lower[near[0]]}?" if near else "; give ra and dec instead"
    raise UnknownTarget(f"no star called {name!r} in the catalogue{hint}")
