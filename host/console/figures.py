"""Readings as people read them."""

from __future__ import annotations

import math
from typing import NamedTuple

from host.sky.angles import format_degrees
from host.sky.observed import Observed
from host.telescope import Snapshot, Telescope


class Pointing(NamedTuple):
    """Where the telescope points; `place` for the sky map."""

    right_ascension: str
    declination: str
    hour_angle: str
    altitude: str
    azimuth: str
    place: Observed | None


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
