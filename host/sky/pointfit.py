"""From stars to a pointing model: least squares, terms kept where stars that are held out gain by them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bus.units import ARCSEC_PER_RAD
from host.sky.mount import Mount
from host.sky.pointmodel import PointingModel, Term
from host.sky.pointterms import GEOMETRY, TERMS, ZEROS, Array

FEWEST_STARS = 6
"""Twelve coordinates for the six terms of geometry. ASSUMPTION: twice as many as unknowns."""
STARS_PER_TERM = 3
"""Stars for each term beyond those six: so a run of 20, the shortest planned, can hold ten. ASSUMPTION."""
_SIGNIFICANT = 3.6
"""A coefficient over its standard deviation: eight candidates that are nothing pass it once in 400 fits, as a
normal error does so with 3.2e-4."""
_NEW = 1e-3
"""Share of a column that those before must leave, or the sky seen cannot tell them apart. ASSUMPTION."""
_APART = 0.05
"""Least singular value of the six columns: six stars drawn over the sky had 0.09 and more. ASSUMPTION."""
_FOLDS = 3
"""Parts of the stars, each held out in turn. ASSUMPTION: a run of 20 keeps 13 for ten terms."""
_INTERVAL = 1.96
"""Standard deviations of a 95 % interval of a normal error."""
_TURNS = 3
"""Formulas are of first order: a coefficient of 300″ moves by 0.4″ after the first solution."""


class TooFewStars(ValueError):
    """Fewer stars than a model needs, or all in one place."""


@dataclass(frozen=True, kw_only=True)
class Sighting:
    """Where the telescope was seen to look, observed place, and what its encoders read."""

    hour_angle_rad: float
    declination_rad: float
    ra_steps: int
    dec_steps: int


@dataclass(frozen=True)
class _Stars:
    h: Array
    d: Array
    ra: Array
    dec: Array
    latitude: float

    def take(self, rows: Array) -> _Stars:
        return _Stars(self.h[rows], self.d[rows], self.ra[rows], self.dec[rows], self.latitude)

    def columns(self, names: Sequence[str]) -> Array:
        """(2 n, terms): east-west of all stars, then north-south."""
        return np.stack(
            [np.concatenate(TERMS[name](self.h, self.d, self.latitude)) for name in names], axis=1
        )

    def residuals(self, names: Sequence[str], values: Array) -> Array:
        """Reading less what a model says, ″, (2 n,)."""
        ra, dec = _model(names, values, self.latitude).axes_many(self.h, self.d)
        off = np.remainder(self.ra - ra + np.pi, 2 * np.pi) - np.pi
        return np.concatenate([off * np.cos(self.d), self.dec - dec]) * ARCSEC_PER_RAD


def fit(
    sightings: Sequence[Sighting], mount: Mount, latitude_rad: float, names: tuple[str, ...] | None = None
) -> PointingModel:
    """The model of stars seen; raises TooFewStars. names: the terms, if they are not to be chosen."""
    if len(sightings) < FEWEST_STARS:
        raise TooFewStars(f"a pointing model needs {FEWEST_STARS} stars, there are {len(sightings)}")
    stars = _Stars(
        np.array([each.hour_angle_rad for each in sightings]),
        np.array([each.declination_rad for each in sightings]),
        np.array([mount.ra.angle_rad(each.ra_steps) for each in sightings]),
        np.array([mount.dec.angle_rad(each.dec_steps) for each in sightings]),
        latitude_rad,
    )
    if np.linalg.matrix_rank(stars.columns(GEOMETRY), tol=_APART) < len(GEOMETRY):
        raise TooFewStars("the stars stand too close together; take some all over the sky")
    names = _chosen(stars) if names is None else names
    values = _solve(stars, names)
    after = stars.residuals(names, values)
    design = stars.columns(names)
    variance = after @ after / (len(after) - len(names))
    spread = _INTERVAL * np.sqrt(variance * np.diag(np.linalg.inv(design.T @ design)))
    return PointingModel(
        latitude_rad=latitude_rad,
        terms=_terms(names, values, spread),
        stars=len(sightings),
        before_arcsec=_rms(stars.residuals(ZEROS, _solve(stars, ZEROS))),
        after_arcsec=_rms(after),
        held_out_arcsec=_held_out(stars, names),
    )


def _chosen(stars: _Stars) -> tuple[str, ...]:
    """The six of geometry, then one by one what is significant and helps stars that are held out."""
    names: tuple[str, ...] = GEOMETRY
    best = _held_out(stars, names)
    while len(stars.h) >= FEWEST_STARS + STARS_PER_TERM * (len(names) + 1 - len(GEOMETRY)):
        found = _candidate(stars, names)
        if found is None:
            break
        score = _held_out(stars, (*names, found))
        if score >= best:
            break
        names, best = (*names, found), score
    return names


def _candidate(stars: _Stars, names: tuple[str, ...]) -> str | None:
    """The most significant term that is left, if it is significant."""
    residuals = stars.residuals(names, _solve(stars, names))
    basis, _ = np.linalg.qr(stars.columns(names))
    scores: dict[str, float] = {}
    for name in TERMS:
        column = stars.columns((name,))[:, 0]
        new = column - basis @ (basis.T @ column)
        if name in names or new @ new < _NEW * (column @ column):
            continue
        value = float(new @ residuals) / float(new @ new)
        rest = residuals - value * new
        deviation = float(np.sqrt(rest @ rest / (len(rest) - len(names) - 1) / (new @ new)))
        scores[name] = abs(value) / max(deviation, 1e-12)
    # DAF is HCEC and NP: equal scores differ by rounding, and the first of the table is taken.
    found = max(scores, key=lambda each: round(scores[each], 6), default="")
    return found if scores.get(found, 0.0) > _SIGNIFICANT else None


def _held_out(stars: _Stars, names: Sequence[str]) -> float:
    """Rms of every star under a model of the others: a third is held out in turn."""
    rows = np.arange(len(stars.h))
    parts = []
    for fold in range(_FOLDS):
        held = rows % _FOLDS == fold
        parts.append(stars.take(held).residuals(names, _solve(stars.take(~held), names)))
    return _rms(np.concatenate(parts))


def _solve(stars: _Stars, names: Sequence[str]) -> Array:
    """Least squares of both coordinates, ″, (terms,)."""
    design = stars.columns(names)
    values = np.zeros(len(names))
    for _ in range(_TURNS):
        values = values + np.linalg.lstsq(design, stars.residuals(names, values), rcond=None)[0]
    return values


def _model(names: Sequence[str], values: Array, latitude_rad: float) -> PointingModel:
    terms = _terms(names, values, np.zeros(len(names)))
    return PointingModel(
        latitude_rad=latitude_rad, terms=terms, stars=0, before_arcsec=0.0, after_arcsec=0.0,
        held_out_arcsec=0.0,
    )  # fmt: skip


def _terms(names: Sequence[str], values: Array, spread: Array) -> tuple[Term, ...]:
    rows = zip(names, values.tolist(), spread.tolist(), strict=True)
    return tuple(Term(name=name, arcsec=value, within_arcsec=within) for name, value, within in rows)


def _rms(values: Array) -> float:
    """Of the distance on the sky, from both coordinates."""
    return float(np.sqrt(2 * np.mean(values**2)))
