"""A pointing model: a few terms that take the sky to the axes and back, and its file."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bus.units import ARCSEC_PER_RAD

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

FORMAT = "schmidt-pointing 1"
_NEAR_RAD = 1e-10
"""The way back ends when it moves by less, 0.00002″."""
_MOST_TURNS = 50
"""Three turns do; near the pole, where a cone of 1′ hides all within 1′, it takes more."""

_MOST_ARCSEC = 324_000.0
"""Largest term, 90°. ASSUMPTION: the zero of an axis may be anywhere, no mount has more of anything else."""


@dataclass(frozen=True, kw_only=True)
class Term:
    """A fitted coefficient in arcsec, and half of its 95 % interval."""

    name: str
    arcsec: float
    within_arcsec: float


@dataclass(frozen=True, kw_only=True)
class PointingModel:
    """Terms (host/sky/pointmodel.py) at a latitude, and how well they fit: rms of the distance on the sky, ″.

    before: without the model, but for the zeros of both axes. held_out: of stars that were not fitted.
    """

    latitude_rad: float
    terms: tuple[Term, ...]
    stars: int
    before_arcsec: float
    after_arcsec: float
    held_out_arcsec: float

    def axes(self, hour_angle_rad: float, declination_rad: float) -> tuple[float, float]:
        """Angles of both axes, rad, that look at an observed hour angle and declination."""
        ra, dec = self.axes_many(np.array(hour_angle_rad), np.array(declination_rad))
        return float(ra), float(dec)

    def axes_many(self, hour_angle_rad: Array, declination_rad: Array) -> tuple[Array, Array]:
        """The same of many places: all of one shape."""
        h, d = self._moved(hour_angle_rad, declination_rad, True)
        h, d = self._back(h, d, False)
        return h + self._zero("IH"), d + self._zero("ID")

    def sky(self, ra_rad: float, dec_rad: float) -> tuple[float, float]:
        """Observed hour angle and declination, rad, that the axes at these angles look at."""
        h, d = np.array(ra_rad - self._zero("IH")), np.array(dec_rad - self._zero("ID"))
        h, d = self._moved(h, d, False)
        h, d = self._back(h, d, True)
        return float(h), float(d)

    def save(self, path: Path) -> None:
        """Write the model as JSON."""
        text = json.dumps({"format": FORMAT} | asdict(self), indent=1)
        path.write_text(text + "\n", encoding="utf-8")

    def _zero(self, name: str) -> float:
        return sum(term.arcsec for term in self.terms if term.name == name) / ARCSEC_PER_RAD

    def _moved(self, h: Array, d: Array, sky_side: bool) -> tuple[Array, Array]:
        """Terms of the sky taken from the sky to the mount, or the mount's from the mount to the sky."""
        return _angles(_vector(h, d) + self._shift(h, d, sky_side), h)

    def _back(self, h: Array, d: Array, sky_side: bool) -> tuple[Array, Array]:
        """The way back: a fixed point."""
        place = _vector(h, d)
        for _ in range(_MOST_TURNS):
            shift = self._shift(h, d, sky_side)
            before = h, d
            h, d = _angles(place * np.sqrt(1 + np.sum(shift**2, axis=0)) - shift, h)
            moved = np.max(np.abs((h - before[0]) * np.cos(d))), np.max(np.abs(d - before[1]))
            if max(moved) < _NEAR_RAD:
                break
        return h, d

    def _shift(self, h: Array, d: Array, sky_side: bool) -> Array:
        """Along the sphere, (3, ...): reading less sky of the sky's terms, the opposite of the mount's."""
        sign = 1.0 if sky_side else -1.0
        west, north = np.zeros_like(h), np.zeros_like(d)
        for term in self.terms:
            if term.name not in ZEROS and (term.name in SKY_SIDE) == sky_side:
                x, y = TERMS[term.name](h, d, self.latitude_rad)
                west = west + term.arcsec / ARCSEC_PER_RAD * x
                north = north + term.arcsec / ARCSEC_PER_RAD * y
        sine, cosine = np.sin(h), np.cos(h)
        along = np.stack([-sine, cosine, np.zeros_like(h)])
        upward = np.stack([-np.sin(d) * cosine, -np.sin(d) * sine, np.cos(d)])
        shift: Array = sign * (west * along + north * upward)
        return shift


def _vector(h: Array, d: Array) -> Array:
    return np.stack([np.cos(d) * np.cos(h), np.cos(d) * np.sin(h), np.sin(d)])


def _angles(vector: Array, near_rad: Array) -> tuple[Array, Array]:
    """Hour angle, within half a turn of another, and declination of a vector of any length, rad."""
    x, y, z = vector
    h = near_rad + np.remainder(np.arctan2(y, x) - near_rad + np.pi, 2 * np.pi) - np.pi
    return h, np.arctan2(z, np.hypot(x, y))


def parsed(text: str, path: Path) -> PointingModel:
    """The model of a file's text; raises ValueError, which names the path."""
    try:
        data = json.loads(text)
    except (RecursionError, ValueError) as error:
        raise ValueError(f"{path}: is not JSON: {error}") from None
    if not isinstance(data, dict) or data.pop("format", None) != FORMAT:
        raise ValueError(f"{path}: expected a JSON object with the format {FORMAT!r}")
    try:
        listed = data.pop("terms")
        if not isinstance(listed, list) or not all(isinstance(each, dict) for each in listed):
            raise ValueError("its terms are no list of objects")
        terms = tuple(Term(**each) for each in listed)
        model = PointingModel(terms=terms, **data)
        if not abs(model.latitude_rad) <= math.pi / 2:
            raise ValueError("the latitude is beyond a pole")
        if not all(abs(size) <= _MOST_ARCSEC for each in terms for size in (each.arcsec, each.within_arcsec)):
            raise ValueError("a term is larger than 90°")
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"{path}: not a pointing model: {error}") from None
    for each in terms:
        if each.name not in tuple(TERMS):  # whatever a file calls it: not all of JSON can be looked up
            raise ValueError(f"{path}: no term is called {each.name!r}; there are {', '.join(TERMS)}")
    return model
