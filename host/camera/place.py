"""Stars on the plane of a detector, and the place in the catalogue that its middle sees."""

import math

import erfa
import numpy as np
import numpy.typing as npt

from host.camera.models import Look
from host.camera.stars import Array, Stars
from host.sky.observed import Clock, quietly, seen_from
from host.sky.site import Site


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
