"""Stars that a telescope was seen to look at, as arrays, and what a set of terms leaves of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bus.units import ARCSEC_PER_RAD
from host.sky.mount import Mount
from host.sky.pointmodel import TERMS, Array, PointingModel, Term

_TURNS = 3
"""Formulas are of first order: a coefficient of 300″ moves by 0.4″ after the first solution."""


@dataclass(frozen=True, kw_only=True)
class Sighting:
    """Where the telescope was seen to look, observed place, and what its encoders read."""

    hour_angle_rad: float
    declination_rad: float
    ra_steps: int
    dec_steps: int


@dataclass(frozen=True, kw_only=True)
class Stars:
    """Observed places `h` and `d` and angles of the axes `ra` and `dec`, rad, (n,) each; others: further
    columns of the run, (n,) each."""

    h: Array
    d: Array
    ra: Array
    dec: Array
    latitude_rad: float
    others: dict[str, Array]

    def columns(self, names: Sequence[str]) -> Array:
        """Of terms, (2 n, terms): east-west of all stars, then north-south."""
        return np.stack(
            [np.concatenate(TERMS[name](self.h, self.d, self.latitude_rad)) for name in names], axis=1
        )

    def off(self, model: PointingModel) -> tuple[Array, Array]:
        """Reading less what a model says, rad on the sky: west, north."""
        ra, dec = model.axes_many(self.h, self.d)
        west = (np.remainder(self.ra - ra + np.pi, 2 * np.pi) - np.pi) * np.cos(self.d)
        return west, self.dec - dec

    def residuals(self, names: Sequence[str], values: Array) -> Array:
        """Reading less what terms of these sizes, ″, say: ″, (2 n,)."""
        return np.concatenate(self.off(model_of(names, values, self.latitude_rad))) * ARCSEC_PER_RAD

    def solve(self, names: Sequence[str]) -> Array:
        """Least squares of both coordinates, ″, (terms,)."""
        design = self.columns(names)
        values = np.zeros(len(names))
        for _ in range(_TURNS):
            values = values + np.linalg.lstsq(design, self.residuals(names, values), rcond=None)[0]
        return values

    def left(self, names: Sequence[str]) -> Array:
        """Residuals of these terms at their best sizes, ″, (2 n,)."""
        return self.residuals(names, self.solve(names))


def stars_of(sightings: Sequence[Sighting], mount: Mount, latitude_rad: float) -> Stars:
    """Sightings as arrays; the mount turns steps of its encoders into angles."""
    return Stars(
        h=np.array([each.hour_angle_rad for each in sightings]),
        d=np.array([each.declination_rad for each in sightings]),
        ra=np.array([mount.ra.angle_rad(each.ra_steps) for each in sightings]),
        dec=np.array([mount.dec.angle_rad(each.dec_steps) for each in sightings]),
        latitude_rad=latitude_rad,
        others={},
    )


def model_of(names: Sequence[str], values: Array, latitude_rad: float) -> PointingModel:
    """Terms of these sizes, ″, that nobody has judged."""
    terms = terms_of(names, values, np.zeros(len(names)))
    return PointingModel(
        latitude_rad=latitude_rad, terms=terms, stars=0, before_arcsec=0.0, after_arcsec=0.0,
        held_out_arcsec=0.0,
    )  # fmt: skip


def terms_of(names: Sequence[str], values: Array, spread: Array) -> tuple[Term, ...]:
    """Terms with their sizes and halves of their intervals, ″."""
    rows = zip(names, values.tolist(), spread.tolist(), strict=True)
    return tuple(Term(name=name, arcsec=value, within_arcsec=within) for name, value, within in rows)


def rms(values: Array) -> float:
    """Of the distance on the sky, from both coordinates."""
    return float(np.sqrt(2 * np.mean(values**2)))
