"""From the catalogue to the sky as the telescope sees it: observed hour angle, declination and their rates.

ERFA's `atco13` does precession and nutation (IAU 2006/2000A), aberration, light deflection, parallax, Earth
rotation and refraction in one go. So none of it is written here.
"""

import datetime as dt
import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import erfa
import numpy as np
import numpy.typing as npt

from bus.units import ARCSEC_PER_RAD
from host.sky.angles import wrap_pi
from host.sky.catalogue import Star
from host.sky.site import Site

_MAS_PER_RAD = ARCSEC_PER_RAD * 1000
_SECONDS_PER_DAY = 86400.0
_RATE_STEP_S = 1.0
"""Rates are central differences over ±1 s: what the third derivative adds is below 1e-9 ″/s."""


def quietly(call: Callable[..., Any], *arguments: Any) -> Any:
    """Call a function of ERFA. To it, dates past the leap-second table are "dubious": no leap second has been
    announced for them."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", erfa.ErfaWarning)
        return call(*arguments)


class Observed(NamedTuple):
    """An observed place, refraction included, in radians: hour angle positive west, azimuth N through E."""

    hour_angle_rad: float
    declination_rad: float
    altitude_rad: float
    azimuth_rad: float


class Rates(NamedTuple):
    """How fast the observed place moves, in arcsec of each axis per second."""

    hour_angle_arcsec_s: float
    declination_arcsec_s: float


@dataclass(frozen=True)
class Clock:
    """Simulated time against UTC: nanosecond 0 of a run is this instant."""

    start_utc: dt.datetime

    def __post_init__(self) -> None:
        if self.start_utc.tzinfo is None:
            raise ValueError("start_utc has no time zone; write it like 2026-02-10T14:00:00Z")

    def julian(self, t_s: float) -> tuple[float, float]:
        """UTC as ERFA's two-part quasi Julian date."""
        start = self.start_utc.astimezone(dt.UTC)
        seconds = start.second + start.microsecond / 1e6
        date = start.year, start.month, start.day, start.hour, start.minute, seconds
        day, fraction = quietly(erfa.dtf2d, "UTC", *date)
        return float(day), float(fraction) + t_s / _SECONDS_PER_DAY

    def iso(self, t_s: float) -> str:
        """UTC of a simulated time as text, to the millisecond."""
        when = self.start_utc.astimezone(dt.UTC) + dt.timedelta(microseconds=round(t_s * 1e6))
        return when.strftime("%Y-%m-%dT%H:%M:%S.") + f"{when.microsecond // 1000:03d}Z"


def observe(star: Star, site: Site, clock: Clock, t_s: float) -> Observed:
    """Observed place of a star at a simulated time."""
    track = observe_many(star, site, clock, np.array([t_s]))
    return Observed(*(float(column[0]) for column in track))


def observe_many(
    star: Star, site: Site, clock: Clock, t_s: npt.NDArray[np.float64]
) -> tuple[npt.NDArray[np.float64], ...]:
    """Observed places for an array of times: hour angle (−π..π), declination, altitude and azimuth."""
    day, fraction = clock.julian(0.0)
    azimuth, zenith, hour_angle, declination, _, _ = quietly(
        erfa.atco13,
        star.right_ascension_rad,
        star.declination_rad,
        star.pm_ra_mas_yr / _MAS_PER_RAD / math.cos(star.declination_rad),
        star.pm_dec_mas_yr / _MAS_PER_RAD,
        star.parallax_mas / 1000,
        0.0,  # radial velocity: perspective acceleration is below 0.01″ per century for all stars listed
        day,
        fraction + np.asarray(t_s) / _SECONDS_PER_DAY,
        *site.erfa,
    )
    return (
        np.remainder(hour_angle + np.pi, 2 * np.pi) - np.pi,
        np.asarray(declination),
        np.pi / 2 - zenith,
        np.asarray(azimuth),
    )


def seen_from(site: Site, clock: Clock, t_s: float) -> Any:
    """ERFA's parameters of a place at one time, which are the same for all stars (`erfa.apco13`)."""
    return quietly(erfa.apco13, *clock.julian(t_s), *site.erfa)[0]


def observe_all(
    stars: Sequence[Star], site: Site, clock: Clock, t_s: float
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Altitudes and azimuths of many stars at one time, without their proper motions and parallaxes."""
    places = np.array([(star.right_ascension_rad, star.declination_rad) for star in stars]).T
    air = seen_from(site, clock, t_s)
    azimuth, zenith, *_ = erfa.atioq(*erfa.atciqz(*places, air), air)
    return np.pi / 2 - zenith, azimuth


def rates(star: Star, site: Site, clock: Clock, t_s: float) -> Rates:
    """Rates of hour angle and declination with refraction, by central difference."""
    step = _RATE_STEP_S
    hour_angle, declination, _, _ = observe_many(star, site, clock, np.array([t_s - step, t_s + step]))
    scale = ARCSEC_PER_RAD / (2 * step)
    return Rates(
        wrap_pi(float(hour_angle[1] - hour_angle[0])) * scale, float(declination[1] - declination[0]) * scale
    )


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
