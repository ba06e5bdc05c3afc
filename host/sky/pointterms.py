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


def _sine(h: Array, d: Array, latitude: float) -> Array:
    """Of the altitude."""
    sine: Array = np.sin(latitude) * np.sin(d) + np.cos(latitude) * np.cos(d) * np.cos(h)
    return sine


def _refracted(h: Array, d: Array, latitude: float) -> tuple[Array, Array]:
    east, north = _down(h, d, latitude)
    # at least the sine of 5 degrees: a formula with tan z ends there. ASSUMPTION
    height = np.maximum(_sine(h, d, latitude), np.sin(np.radians(5.0)))
    return east / height, north / height


_TABLE: dict[str, tuple[str, Formula]] = {
    "IH": ("zero of hour angle", lambda h, d, _: (np.cos(d), 0 * h)),
    "ID": ("zero of declination", lambda h, d, _: (0 * h, 1 + 0 * d)),
    "CH": ("line of sight not perpendicular to the declination axis", lambda h, d, _: (1 + 0 * h, 0 * d)),
    "NP": ("axes not perpendicular", lambda h, d, _: (np.sin(d), 0 * h)),
    "MA": ("polar axis off in azimuth", lambda h, d, _: (-np.cos(h) * np.sin(d), np.sin(h))),
    "ME": ("polar axis off in altitude", lambda h, d, _: (np.sin(h) * np.sin(d), np.cos(h))),
    "TF": ("tube bends, sin z", _down),
    "TX": ("refraction left over, tan z", _refracted),
    "DAF": ("declination axis bends", lambda h, d, latitude: (-_sine(h, d, latitude), 0 * h)),
    "FO": ("fork bends", lambda h, d, _: (0 * h, np.cos(h))),
    "HCES": ("hour angle encoder off its centre, sine", lambda h, d, _: (np.sin(h) * np.cos(d), 0 * h)),
    "HCEC": ("hour angle encoder off its centre, cosine", lambda h, d, _: (np.cos(h) * np.cos(d), 0 * h)),
    "DCES": ("declination encoder off its centre, sine", lambda h, d, _: (0 * h, np.sin(d))),
    "DCEC": ("declination encoder off its centre, cosine", lambda h, d, _: (0 * h, np.cos(d))),
}
"""P. T. Wallace, TPOINT: a telescope pointing analysis system (2011), section on the pointing terms."""
TEXTS = {name: text for name, (text, _) in _TABLE.items()}
TERMS = {name: formula for name, (_, formula) in _TABLE.items()}
ZEROS = ("IH", "ID")
GEOMETRY = ("IH", "ID", "CH", "NP", "MA", "ME")
"""Every equatorial mount has these six, so every model does."""
SKY_SIDE = ("TF", "TX", "MA", "ME")
"""Taken at the place on the sky. The others are the mount's and taken at its own hour angle and declination:
near the pole the two differ by degrees."""
