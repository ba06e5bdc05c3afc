"""Stars that a telescope with a known mount was seen to look at; the mount is the plant's, by rotations."""

import dataclasses
import math

import numpy as np

from bus.units import ARCSEC, ARCSEC_PER_RAD
from host.sky.mount import limits_mount
from host.sky.pointmodel import Array, PointingModel, Term
from host.sky.pointstars import Sighting
from plant.mount import sky
from plant.parts import MountErrors, Number

LATITUDE = math.radians(29 + 22 / 60)
MOUNT = limits_mount(math.radians(100), math.radians(-45), math.radians(92), LATITUDE)
NAMES = {
    "hour_angle_index": "IH", "declination_index": "ID", "polar_azimuth": "MA", "polar_altitude": "ME",
    "collimation": "CH", "non_perpendicularity": "NP", "tube_flexure": "TF", "fork_flexure": "FO",
    "axis_flexure": "DAF", "refraction": "TX", "hour_angle_eccentricity": "HCES",
    "declination_eccentricity": "DCES",
}  # fmt: skip
"""Numbers of a plant file to Wallace's names."""


def errors(**arcsec: float) -> MountErrors:
    """A mount with these errors only."""
    every = dict.fromkeys(NAMES, 0.0) | arcsec
    return MountErrors(**{name: Number(value, "arcsec", "test") for name, value in every.items()})


def drawn(seed: int) -> MountErrors:
    """Errors of either sign, up to twice the typical size."""
    random = np.random.default_rng(seed)
    typical = {
        each.name: abs(getattr(MountErrors(), each.name).value) for each in dataclasses.fields(MountErrors)
    }
    return errors(**{name: float(random.uniform(-2, 2)) * size for name, size in typical.items()})


def axes(count: int, seed: int, low_deg: float = 17.0) -> tuple[Array, Array]:
    """Axis angles, rad, equally dense all over the sky above an altitude."""
    random = np.random.default_rng(seed)
    h = random.uniform(-math.radians(98), math.radians(98), 40 * count)
    d = np.arcsin(random.uniform(math.sin(math.radians(-44)), 1.0, 40 * count))
    altitude = np.arcsin(np.sin(LATITUDE) * np.sin(d) + np.cos(LATITUDE) * np.cos(d) * np.cos(h))
    high = altitude > math.radians(low_deg)
    return h[high][:count], d[high][:count]


def sightings(mount: MountErrors, count: int, seed: int, noise_arcsec: float = 0.3) -> list[Sighting]:
    """Stars of a run, seen with an error of this standard deviation in each coordinate."""
    ra, dec = axes(count, seed)
    h, d = sky(ra, dec, LATITUDE, mount)
    west, north = np.random.default_rng(seed + 1).normal(0, noise_arcsec * ARCSEC, (2, count))
    rows = zip(h + west / np.cos(d), d + north, ra, dec, strict=True)
    return [
        Sighting(
            hour_angle_rad=float(a), declination_rad=float(b), ra_steps=MOUNT.ra.steps(x),
            dec_steps=MOUNT.dec.steps(y),
        )
        for a, b, x, y in rows
    ]  # fmt: skip


def misses(model: PointingModel, mount: MountErrors, count: int, seed: int) -> Array:
    """How far from new stars the telescope looks when it is sent to them by the model, ″."""
    wanted = axes(count, seed, 20.0)
    ra, dec = model.axes_many(*wanted)
    h, d = sky(ra, dec, LATITUDE, mount)
    off = np.remainder(h - wanted[0] + np.pi, 2 * np.pi) - np.pi
    away: Array = np.hypot(off * np.cos(wanted[1]), d - wanted[1]) * ARCSEC_PER_RAD
    return away


def plain(**arcsec: float) -> PointingModel:
    """A model with these terms, by name."""
    terms = tuple(Term(name=name, arcsec=value, within_arcsec=0.0) for name, value in arcsec.items())
    return PointingModel(
        latitude_rad=LATITUDE, terms=terms, stars=0, before_arcsec=0.0, after_arcsec=0.0, held_out_arcsec=0.0
    )
