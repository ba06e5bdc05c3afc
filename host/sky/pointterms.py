"""The terms of a pointing model, in Wallace's names: first-order formulas of what the axes read too much."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Formula = Callable[[Array, Array, float], tuple[Array, Array]]
"""(hour angle, declination, latitude), rad -> reading less sky of a unit coefficient: east-west on the sky
(hour angle times cos declination), north-south."""


def _down(h: Array, d: Array, latitude: float) -> tuple[Array, Array]:
    """The direction of falling altitude, as long as sin z."""
    cosine, sine = np.cos(latitude), np.sin(latitude)
    return cosine * np.sin(h), cosine * np.cos(h) * np.sin(d) - sine * np.cos(d)


def _height(h: Array, d: Array, latitude: float) -> Array:
    """Sine of the altitude, at least that of 5 degrees: a formula with tan z ends there. ASSUMPTION."""
    sine: Array = np.sin(latitude) * np.sin(d) + np.cos(latitude) * np.cos(d) * np.cos(h)
    return np.maximum(sine, np.sin(np.radians(5.0)))


def _refracted(h: Array, d: Array, latitude: float) -> tuple[Array, Array]:
    east, north = _down(h, d, latitude)
    height = _height(h, d, latitude)
    return east / height, north / height


def _sagging(h: Array, d: Array, latitude: float) -> tuple[Array, Array]:
    return -(np.cos(latitude) * np.cos(h) * np.cos(d) + np.sin(latitude) * np.sin(d)), 0 * h


TERMS: dict[str, Formula] = {
    "IH": lambda h, d, _: (np.cos(d), 0 * h),
    "ID": lambda h, d, _: (0 * h, 1 + 0 * d),
    "CH": lambda h, d, _: (1 + 0 * h, 0 * d),
    "NP": lambda h, d, _: (np.sin(d), 0 * h),
    "MA": lambda h, d, _: (-np.cos(h) * np.sin(d), np.sin(h)),
    "ME": lambda h, d, _: (np.sin(h) * np.sin(d), np.cos(h)),
    "TF": _down,
    "TX": _refracted,
    "DAF": _sagging,
    "FO": lambda h, d, _: (0 * h, np.cos(h)),
    "HCES": lambda h, d, _: (np.sin(h) * np.cos(d), 0 * h),
    "HCEC": lambda h, d, _: (np.cos(h) * np.cos(d), 0 * h),
    "DCES": lambda h, d, _: (0 * h, np.sin(d)),
    "DCEC": lambda h, d, _: (0 * h, np.cos(d)),
}
"""P. T. Wallace, TPOINT: a telescope pointing analysis system (2011), section on the pointing terms."""
TEXTS: dict[str, str] = {
    "IH": "zero of hour angle",
    "ID": "zero of declination",
    "CH": "line of sight not perpendicular to the declination axis",
    "NP": "axes not perpendicular",
    "MA": "polar axis off in azimuth",
    "ME": "polar axis off in altitude",
    "TF": "tube bends, sin z",
    "TX": "refraction left over, tan z",
    "DAF": "declination axis bends",
    "FO": "fork bends",
    "HCES": "hour angle encoder off its centre, sine",
    "HCEC": "hour angle encoder off its centre, cosine",
    "DCES": "declination encoder off its centre, sine",
    "DCEC": "declination encoder off its centre, cosine",
}
ZEROS = ("IH", "ID")
GEOMETRY = ("IH", "ID", "CH", "NP", "MA", "ME")
"""Every equatorial mount has these six, so every model does."""
SKY_SIDE = ("TF", "TX", "MA", "ME")
"""Taken at the place on the sky. The others are the mount's and taken at its own hour angle and declination:
near the pole the two differ by degrees."""
