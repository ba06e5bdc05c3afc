"""The stars of a field: a catalogue of one's own, or a synthetic sky with bright stars in their places."""

import math
from collections.abc import Iterable
from dataclasses import astuple, replace
from pathlib import Path
from typing import Final, NamedTuple

import erfa
import numpy as np
import numpy.typing as npt

from bus.time import generator
from bus.units import ARCSEC_PER_RAD
from host.camera.models import Look
from host.sky.catalogue import STARS, Star
from host.sky.listed import read
from host.sky.observed import Clock, quietly, seen_from
from host.sky.site import Site

Array = npt.NDArray[np.float64]
FAINTEST: Final = 14.0
"""Magnitude at which the synthetic sky ends. ASSUMPTION: some thousand stars on the large detector."""
BRIGHTEST: Final = 4.0
"""Where it begins; brighter stars have names. ASSUMPTION."""
_AT_10, _SLOPE = 7.9, 0.43
"""Stars brighter than 10 mag per square degree, and the decimal growth per magnitude.

Source: the mean sky of Allen, Astrophysical Quantities (1973), section 117. Error: a quarter.
"""
_CELL = math.radians(1.0)
_MAS_PER_RAD = ARCSEC_PER_RAD * 1000


class Stars(NamedTuple):
    """Places in the ICRS at J2000.0, rad; proper motions in rad/yr, that in RA without the cosine."""

    right_ascension: Array
    declination: Array
    magnitude: Array
    pm_ra: Array
    pm_dec: Array
    parallax_arcsec: Array

    def near(self, right_ascension: float, declination: float, radius: float) -> "Stars":
        """Those within a radius, rad."""
        away = erfa.seps(self.right_ascension, self.declination, right_ascension, declination)
        return self.where(away <= radius)

    def where(self, kept: npt.NDArray[np.bool_]) -> "Stars":
        """Some of them."""
        return Stars(*(column[kept] for column in self))


def stars(ra: npt.ArrayLike, dec: npt.ArrayLike, magnitude: npt.ArrayLike) -> Stars:
    """Stars without proper motions."""
    columns = [np.asarray(each, dtype=float) for each in (ra, dec, magnitude)]
    return Stars(*columns, *[np.zeros_like(columns[0])] * 3)


def from_file(path: Path) -> Stars:
    """A CSV with columns name, ra, dec, magnitude (`host.sky.listed`); raises ValueError with its line."""
    found = read(path)
    for each in found:
        if each.magnitude is None:
            raise ValueError(f"{path}: {each.star.name} has no magnitude; a camera needs one")
    return _of(replace(each.star, magnitude=each.magnitude) for each in found)


def _of(named: Iterable[Star]) -> Stars:
    numbers = [astuple(star)[1:] for star in named]
    ra, dec, pm_ra, pm_dec, parallax, _, magnitude = np.array(numbers, dtype=float).reshape(-1, 7).T
    motion = pm_ra / _MAS_PER_RAD / np.cos(dec), pm_dec / _MAS_PER_RAD
    return Stars(ra, dec, magnitude, *motion, parallax / 1000)


class SyntheticSky:
    """The same stars for everybody, cell by cell of about a square degree."""

    def near(self, right_ascension: float, declination: float, radius: float) -> Stars:
        """Synthetic and bright stars within a radius, all rad."""
        reach = radius + 2 * _CELL
        found = [_of(STARS.values())]
        low, high = (math.floor((declination + side * reach) / _CELL) for side in (-1, 1))
        for band in range(low, high + 1):
            middle = (band + 0.5) * _CELL
            if abs(middle) > math.pi / 2:
                continue
            count = max(1, round(2 * math.pi * math.cos(middle) / _CELL))
            ra = (np.arange(count) + 0.5) * 2 * math.pi / count
            away = erfa.seps(ra, middle, right_ascension, declination)
            found += [self._cell(band, int(k), count) for k in np.flatnonzero(away <= reach)]
        joined = Stars(*map(np.concatenate, zip(*found, strict=True)))
        return joined.near(right_ascension, declination, radius)

    def _cell(self, band: int, number: int, count: int) -> Stars:
        random = generator(0, f"sky {band} {number}")
        low, high = math.sin(band * _CELL), math.sin((band + 1) * _CELL)
        area_deg2 = (high - low) * 2 * math.pi / count * math.degrees(1) ** 2
        expected = _AT_10 * 10 ** (_SLOPE * (FAINTEST - 10)) * area_deg2
        share = random.uniform(10 ** (_SLOPE * (BRIGHTEST - FAINTEST)), 1.0, random.poisson(expected))
        ra = (number + random.uniform(0, 1, len(share))) * 2 * math.pi / count
        dec = np.arcsin(random.uniform(low, high, len(share)))
        return stars(ra, dec, FAINTEST + np.log10(share) / _SLOPE)


def observed(found: Stars, site: Site, clock: Clock, t_s: float) -> tuple[Array, Array]:
    """Observed hour angles and declinations of stars at one time, rad."""
    air = seen_from(site, clock, t_s)
    place = erfa.atciq(
        found.right_ascension, found.declination, found.pm_ra, found.pm_dec, found.parallax_arcsec,
        np.zeros_like(found.declination), air,
    )  # fmt: skip
    _, _, hour_angle, declination, _ = erfa.atioq(*place, air)
    return np.asarray(hour_angle), np.asarray(declination)


def catalogued(look: Look, site: Site, clock: Clock) -> tuple[float, float]:
    """The ICRS place that is seen where the telescope looks, rad."""
    seen = look.hour_angle_rad, look.declination_rad, *clock.julian(look.t_ns * 1e-9)
    ra, dec = quietly(erfa.atoc13, "H", *seen, *site.erfa)
    return float(ra), float(dec)


def plane(hour_angle: Array, declination: Array, look: Look) -> tuple[Array, Array]:
    """Gnomonic coordinates about a look: to the right (west) and up (north), turned by its roll."""
    off, here = hour_angle - look.hour_angle_rad, look.declination_rad
    depth = math.sin(here) * np.sin(declination) + math.cos(here) * np.cos(declination) * np.cos(off)
    depth = np.where(depth > 0.1, depth, np.nan)  # behind the telescope
    west = np.cos(declination) * np.sin(off) / depth
    north = (
        math.cos(here) * np.sin(declination) - math.sin(here) * np.cos(declination) * np.cos(off)
    ) / depth
    c, s = math.cos(look.roll_rad), math.sin(look.roll_rad)
    return np.asarray(west * c - north * s), np.asarray(west * s + north * c)


def turning(look: Look, step_rad: float, site: Site, clock: Clock) -> npt.NDArray[np.float64]:
    """Degrees of ICRS (RA times cosine, declination) per radian to the right and up: a 2 by 2 matrix."""
    ra0, dec0 = catalogued(look, site, clock)
    columns = []
    for right, up in ((step_rad, 0.0), (0.0, step_rad)):
        c, s = math.cos(look.roll_rad), math.sin(look.roll_rad)
        west, north = right * c + up * s, up * c - right * s
        hour_angle_rad = look.hour_angle_rad + west / math.cos(look.declination_rad)
        moved = look._replace(hour_angle_rad=hour_angle_rad, declination_rad=look.declination_rad + north)
        ra, dec = catalogued(moved, site, clock)
        east = math.remainder(ra - ra0, 2 * math.pi) * math.cos(dec0)
        columns.append((math.degrees(east) / step_rad, math.degrees(dec - dec0) / step_rad))
    return np.array(columns).T


Sky = Stars | SyntheticSky
"""All stars there are, in a radius about a place."""
