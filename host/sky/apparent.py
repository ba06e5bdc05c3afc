"""Between the encoders and the places astronomers' programs speak of: apparent places of date ("JNow").

JNow here is the apparent geocentric place: equinox and equator of date, with precession, nutation and
aberration, without refraction. That is what INDI's LX200 drivers, Stellarium's LX200 plug-in and Alpaca's
equatorial system 1 mean. ERFA's `atci13`, `atic13` and `atoi13` do all of it.
"""

import math
from typing import NamedTuple

import erfa

from host.sky.catalogue import Star
from host.sky.observed import Clock, Observed, quietly
from host.sky.site import Site


class Place(NamedTuple):
    """An apparent place of date in radians: right ascension 0..2π, declination."""

    right_ascension_rad: float
    declination_rad: float


def star_of_apparent(place: Place, clock: Clock, t_s: float, name: str) -> Star:
    """The ICRS place that has this apparent place now; a telescope tracks it like a star."""
    time = terrestrial(clock, t_s)
    origins = erfa.eo06a(*time)
    ra, dec, _ = erfa.atic13(place.right_ascension_rad + origins, place.declination_rad, *time)
    return Star(name, float(erfa.anp(ra)), float(dec))


def apparent_of_observed(
    hour_angle_rad: float, declination_rad: float, site: Site, clock: Clock, t_s: float
) -> Place:
    """Apparent place of date that is seen, through the air, at an observed hour angle and declination."""
    ra, dec = quietly(erfa.atoi13, "H", hour_angle_rad, declination_rad, *clock.julian(t_s), *site.erfa)
    return Place(float(erfa.anp(ra - erfa.eo06a(*terrestrial(clock, t_s)))), float(dec))


def horizontal(hour_angle_rad: float, declination_rad: float, site: Site) -> Observed:
    """Altitude and azimuth (north through east) of an observed hour angle and declination."""
    azimuth, altitude = erfa.hd2ae(hour_angle_rad, declination_rad, site.latitude_rad)
    return Observed(hour_angle_rad, declination_rad, float(altitude), float(azimuth))


def equatorial(azimuth_rad: float, altitude_rad: float, site: Site) -> Observed:
    """Observed hour angle and declination of an azimuth (north through east) and altitude."""
    hour_angle, declination = erfa.ae2hd(azimuth_rad, altitude_rad, site.latitude_rad)
    wrapped = math.remainder(float(hour_angle), 2 * math.pi)
    return Observed(wrapped, float(declination), altitude_rad, azimuth_rad)


def sidereal_time_rad(site: Site, clock: Clock, t_s: float) -> float:
    """Local apparent sidereal time, 0..2π."""
    day, fraction = clock.julian(t_s)
    universal = quietly(erfa.utcut1, day, fraction, site.ut1_minus_utc_s)
    greenwich = erfa.gst06a(*universal, *terrestrial(clock, t_s))
    return float(erfa.anp(greenwich + site.longitude_rad))


def terrestrial(clock: Clock, t_s: float) -> tuple[float, float]:
    """Terrestrial time as ERFA's two-part Julian date."""
    day, fraction = erfa.taitt(*quietly(erfa.utctai, *clock.julian(t_s)))
    return float(day), float(fraction)
