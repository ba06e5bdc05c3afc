"""From stars to a pointing model: least squares, terms kept where stars that are held out gain by them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from host.sky.mount import Mount
from host.sky.pointmodel import GEOMETRY, TERMS, ZEROS, Array, PointingModel
from host.sky.pointstars import Sighting, Stars, rms, stars_of, terms_of

FEWEST_STARS = 6
"""Twelve coordinates for the six terms of geometry. ASSUMPTION: twice as many as unknowns."""
STARS_PER_TERM = 3
"""Stars for each term beyond those six: so a run of 20, the shortest planned, can hold ten. ASSUMPTION."""
SIGNIFICANT = 3.6
"""A coefficient over its standard deviation: eight candidates that are nothing pass it once in 400 fits, as a
normal error does so with 3.2e-4."""
NEW = 1e-3
"""Share of a column that those before must leave, or the sky seen cannot tell them apart. ASSUMPTION."""
_APART = 0.05
"""Least singular value of the six columns: six stars drawn over the sky had 0.09 and more. ASSUMPTION."""
_FOLDS = 3
"""Parts of the stars, each held out in turn. ASSUMPTION: a run of 20 keeps 13 for ten terms."""
_INTERVAL = 1.96
"""Standard deviations of a 95 % interval of a normal error."""


class TooFewStars(ValueError):
    """Fewer stars than a model needs, or all in one place."""


def fit(
    sightings: Sequence[Sighting], mount: Mount, latitude_rad: float, names: tuple[str, ...] | None = None
) -> PointingModel:
    """The model of stars seen; raises TooFewStars. names: the terms, if they are not to be chosen."""
    return fit_stars(stars_of(sightings, mount, latitude_rad), names)


def fit_stars(
    stars: Stars, names: tuple[str, ...] | None = None, declared: tuple[str, ...] = GEOMETRY
) -> PointingModel:
    """The same of stars that are arrays already. declared: terms that are fitted whatever they gain."""
    count = len(stars.h)
    if count < FEWEST_STARS:
        raise TooFewStars(f"a pointing model needs {FEWEST_STARS} stars, there are {count}")
    if np.linalg.matrix_rank(stars.columns(GEOMETRY), tol=_APART) < len(GEOMETRY):
        raise TooFewStars("the stars stand too close together; take some all over the sky")
    if names is None:
        found = (_grown(stars, declared), _pruned(stars, declared))
        names = min(found, key=lambda each: held_out(stars.columns(each), stars.left(each)))
    values = stars.solve(names)
    after = stars.residuals(names, values)
    design = stars.columns(names)
    variance = after @ after / (len(after) - len(names))
    spread = _INTERVAL * np.sqrt(variance * np.diag(np.linalg.inv(design.T @ design)))
    return PointingModel(
        latitude_rad=stars.latitude_rad,
        terms=terms_of(names, values, spread),
        stars=count,
        before_arcsec=rms(stars.left(ZEROS)),
        after_arcsec=rms(after),
        held_out_arcsec=held_out(design, after),
    )


def _most(stars: Stars) -> int:
    """Terms that so many stars can hold."""
    return len(GEOMETRY) + (len(stars.h) - FEWEST_STARS) // STARS_PER_TERM


def _pruned(stars: Stars, declared: tuple[str, ...]) -> tuple[str, ...]:
    """All terms that this sky tells apart, less one by one what is not significant beside the others.

    Two errors that hide each other are found this way only. The declared terms where stars are too few.
    """
    names = declared
    for name in (each for each in TERMS if each not in declared):
        names += (name,) if beside(stars.columns((name,))[:, 0], stars.columns(names)) is not None else ()
    if len(names) > _most(stars):
        return declared
    while more := [name for name in names if name not in declared]:
        scores = {name: beside_others(stars, names, name) for name in more}
        least = min(scores, key=lambda each: scores[each])
        if scores[least] > SIGNIFICANT:
            break
        names = tuple(name for name in names if name != least)
    return names


def beside_others(stars: Stars, names: tuple[str, ...], name: str, *more: Array) -> float:
    """Significance of one of the terms beside the others, and more columns."""
    others = tuple(each for each in names if each != name)
    design = np.hstack([stars.columns(others), *more])
    return significance(stars.columns((name,))[:, 0], design, stars.left(others))


def _grown(stars: Stars, declared: tuple[str, ...]) -> tuple[str, ...]:
    """The declared terms, then one by one what is significant and helps stars that are held out."""
    names = declared
    best = held_out(stars.columns(names), stars.left(names))
    while len(names) < _most(stars):
        found = _candidate(stars, names)
        if found is None:
            break
        score = held_out(stars.columns((*names, found)), stars.left(names))
        if score >= best:
            break
        names, best = (*names, found), score
    return names


def _candidate(stars: Stars, names: tuple[str, ...]) -> str | None:
    """The most significant term that is left, if it is significant."""
    residuals, design = stars.left(names), stars.columns(names)
    columns = {name: stars.columns((name,))[:, 0] for name in TERMS if name not in names}
    scores = {name: significance(column, design, residuals) for name, column in columns.items()}
    # DAF is HCEC and NP: equal scores differ by rounding, and the first of the table is taken.
    found = max(scores, key=lambda each: round(scores[each], 6), default="")
    return found if scores.get(found, 0.0) > SIGNIFICANT else None


def without(design: Array, values: Array) -> Array:
    """Part of values, (2 n,) or (2 n, k), that the columns of a design do not hold."""
    basis, _ = np.linalg.qr(design)
    return np.asarray(values - basis @ (basis.T @ values))


def beside(column: Array, design: Array) -> Array | None:
    """Part of a column (2 n,) that a design does not hold; None: this sky cannot tell the two."""
    new = without(design, column)
    return None if new @ new < NEW * (column @ column) else new


def significance(column: Array, design: Array, residuals: Array) -> float:
    """A column's coefficient over its standard deviation, beside a design."""
    new = beside(column, design)
    if new is None:
        return 0.0
    value = float(new @ residuals) / float(new @ new)
    rest = without(design, residuals) - value * new
    deviation = float(np.sqrt(rest @ rest / (len(rest) - design.shape[1] - 1) / (new @ new)))
    return abs(value) / max(deviation, 1e-12)


def held_out(design: Array, residuals: Array) -> float:
    """Rms of every star under a fit of the others, ″: a third is held out in turn. design: (2 n, columns), as
    `Stars.columns`; residuals: of any sizes of the same terms."""
    part = np.tile(np.arange(len(residuals) // 2) % _FOLDS, 2)
    left = np.empty_like(residuals)
    for fold in range(_FOLDS):
        held = part == fold
        values = np.linalg.lstsq(design[~held], residuals[~held], rcond=None)[0]
        left[held] = residuals[held] - design[held] @ values
    return rms(left)
