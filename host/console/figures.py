"""Readings as people read them."""

import math
from typing import NamedTuple

from host.sky.angles import format_degrees
from host.sky.observed import Observed, horizontal, sidereal_time_rad
from host.telescope import Observatory, Snapshot, Telescope


class Pointing(NamedTuple):
    """Where the telescope points; `place` for the sky map."""

    right_ascension: str
    declination: str
    hour_angle: str
    altitude: str
    azimuth: str
    place: Observed | None


SIDEREAL_RAD_S = 7.292115e-5
"""Rotation of the Earth against the sky (IERS Conventions 2010, table 1.2)."""
NOWHERE = Pointing("–", "–", "–", "–", "–", None)


def hours(angle_rad: float) -> str:
    """hh:mm:ss.s of an angle in 0..2π."""
    tenths = round(math.degrees(angle_rad % (2 * math.pi)) / 15 * 36000) % 864000
    whole, rest = divmod(tenths, 36000)
    minutes, rest = divmod(rest, 600)
    return f"{whole:02d}h{minutes:02d}m{rest / 10:04.1f}s"


def pointing(telescope: Telescope) -> Pointing:
    """From the encoders, through the mount's alignment; apparent place of date."""
    now, about = telescope.snapshot, telescope.observatory
    if now.ra.steps is None or now.dec.steps is None:
        return NOWHERE
    place = about.observed(now.ra.steps, now.dec.steps)
    sky = about.apparent(now.ra.steps, now.dec.steps, now.ra.latched_s)
    return Pointing(
        hours(sky.right_ascension_rad),
        format_degrees(sky.declination_rad),
        format_degrees(place.hour_angle_rad),
        format_degrees(place.altitude_rad),
        format_degrees(place.azimuth_rad),
        place,
    )


class Clocks(NamedTuple):
    """The times of a night, as text; the last three of the place the telescope points to."""

    utc: str
    sidereal: str
    airmass: str
    to_meridian: str
    to_limit: str


def clocks(telescope: Telescope) -> Clocks:
    """Of this moment; a place that is left where it is drifts west with the sky."""
    now, about = telescope.snapshot, telescope.observatory
    utc = about.clock.iso(now.t_s)[11:19]
    sidereal = hours(sidereal_time_rad(about.site, about.clock, now.t_s))[:-3]
    here = pointing(telescope).place
    if here is None:
        return Clocks(utc, sidereal, "–", "–", "–")
    left_rad = math.remainder(-here.hour_angle_rad, 2 * math.pi)
    meridian = f"{duration(abs(left_rad) / SIDEREAL_RAD_S)} {'before' if left_rad > 0 else 'after'}"
    limit_s = until_limit_s(about, here.hour_angle_rad, here.declination_rad)
    return Clocks(
        utc, sidereal, number(airmass(here.altitude_rad), ".2f"), meridian,
        "none today" if limit_s is None else duration(limit_s),
    )  # fmt: skip


def airmass(altitude_rad: float) -> float | None:
    """Kasten and Young, Applied Optics 28 (1989) 4735, of the apparent altitude; None below the horizon."""
    if altitude_rad < 0:
        return None
    degrees = math.degrees(altitude_rad)
    bent: float = 0.50572 * (degrees + 6.07995) ** -1.6364
    return 1 / (math.sin(altitude_rad) + bent)


def until_limit_s(about: Observatory, hour_angle_rad: float, declination_rad: float) -> float | None:
    """Seconds until what is tracked from here meets the horizon limit or a soft limit, to a minute; None:
    within a day it does not."""
    for minute in range(24 * 60):
        angle = hour_angle_rad + minute * 60 * SIDEREAL_RAD_S
        low = horizontal(angle, declination_rad, about.site).altitude_rad < about.horizon_rad
        if low or not about.mount.ra.within(math.remainder(angle, 2 * math.pi)):
            return minute * 60.0
    return None


def duration(seconds: float) -> str:
    """h:mm, cut to the minute."""
    return f"{int(seconds // 3600)}:{int(seconds // 60 % 60):02d} h"


def number(value: float | None, form: str, unit: str = "") -> str:
    """A value with its unit, or a dash."""
    return "–" if value is None else format(value, form) + unit


def summary(now: Snapshot) -> str:
    """One line of what the telescope does."""
    parts = [now.activity]
    if now.target and (now.tracking or now.slewing):
        parts.append(now.target)
    if now.parked:
        parts.append("parked")
    if not now.powered:
        parts.append("motors off")
    if now.ra.fault or now.dec.fault:
        parts.append("FAULT")
    if now.ra.soft_limit or now.dec.soft_limit:
        parts.append("SOFT LIMIT")
    return ", ".join(parts)
