"""The search of a pointing run for what is missing: a term by name, or unknown over a variable."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from host.sky.pointfit import SIGNIFICANT, beside, beside_others, fit_stars, held_out, without
from host.sky.pointmodel import GEOMETRY, TERMS, Array, PointingModel
from host.sky.pointsmooth import Smooth, chance, functions
from host.sky.pointstars import Stars, rms

_CHANCE = 1 / 400
"""Sound runs of which one shows something over any variable: as rare as a false term (pointfit)."""
_AS_WELL = 6.63
"""Twice the log of a likelihood ratio: a term that lags the best by less is as good. It is the 99 % point of
chi² with one degree of freedom."""


@dataclass(frozen=True, kw_only=True)
class Lack:
    """One thing missing.

    - name: a term, or "unknown".
    - equivalent: terms that explain the run as well.
    - over: the variable of an unknown one.
    - arcsec, within_arcsec: a term's size and half of its 95 % interval; of an unknown one its rms, and None.
    """

    name: str
    equivalent: tuple[str, ...]
    over: str | None
    arcsec: float
    within_arcsec: float | None


@dataclass(frozen=True, kw_only=True)
class Answer:
    """Findings of a run, and its model. before, after: of stars held out, rms of the distance, ″, by the
    declared terms and by all. unseen: the least size, ″, at which a term would have been named; a term that
    this sky cannot tell from others is in `confounded`."""

    verdict: str
    lacks: tuple[Lack, ...]
    model: PointingModel
    before_arcsec: float
    after_arcsec: float
    unseen_arcsec: dict[str, float]
    confounded: tuple[str, ...]


def find(stars: Stars, declared: tuple[str, ...] = GEOMETRY) -> Answer:
    """Search for terms beyond the declared ones; raises TooFewStars."""
    model = fit_stars(stars, declared=declared)
    names = tuple(term.name for term in model.terms)
    smooth = _smooth(stars, names)
    while smooth:  # a term that only mimics what depends on the variable goes
        over = [each.columns for each in smooth]
        free = [name for name in names if name not in declared]
        mimics = [name for name in free if beside_others(stars, names, name, *over) <= SIGNIFICANT]
        if not mimics:
            break
        names = tuple(name for name in names if name not in mimics)
        smooth = _smooth(stars, names)
    if smooth:
        model = fit_stars(stars, names)
    lacks = [_term(stars, model, names, smooth, name) for name in names if name not in declared]
    lacks += [_unknown(stars, names, each) for each in smooth]
    unseen, confounded = _limits(stars, names)
    twins = any(lack.equivalent for lack in lacks)
    verdict = "nothing" if not lacks else "unknown" if smooth else "ambiguous" if twins else "found"
    return Answer(
        verdict=verdict,
        lacks=tuple(lacks),
        model=model,
        before_arcsec=_held_out(stars, declared, ()),
        after_arcsec=_held_out(stars, names, smooth),
        unseen_arcsec=unseen,
        confounded=confounded,
    )


def _smooth(stars: Stars, names: tuple[str, ...]) -> tuple[Smooth, ...]:
    """Functions of variables that the rest shows, the surest first, each beside those before."""
    found: tuple[Smooth, ...] = ()
    candidates = functions(stars)
    while True:
        design = _design(stars, names, found)
        chances = [chance(design, each.columns, stars.left(names)) for each in candidates]
        best = int(np.argmin(chances))
        more = (*found, candidates[best])
        if chances[best] * len(candidates) > _CHANCE or any(each is candidates[best] for each in found):
            return found
        if _held_out(stars, names, more) >= _held_out(stars, names, found):
            return found
        found = more


def _design(stars: Stars, names: tuple[str, ...], smooth: tuple[Smooth, ...]) -> Array:
    return np.hstack([stars.columns(names), *(each.columns for each in smooth)])


def _held_out(stars: Stars, names: tuple[str, ...], smooth: tuple[Smooth, ...]) -> float:
    return held_out(_design(stars, names, smooth), stars.left(names))


def _term(
    stars: Stars, model: PointingModel, names: tuple[str, ...],
    smooth: tuple[Smooth, ...], name: str,
) -> Lack:  # fmt: skip
    """A term that is missing, with those that could stand in its place."""
    fitted = next(term for term in model.terms if term.name == name)
    best = _squares(stars, names, smooth)
    equivalent = []
    for other in (each for each in TERMS if each not in names):
        instead = tuple(other if each == name else each for each in names)
        if 2 * len(stars.h) * np.log(_squares(stars, instead, smooth) / best) < _AS_WELL:
            equivalent.append(other)
    return Lack(
        name=name, equivalent=tuple(equivalent), over=None, arcsec=fitted.arcsec,
        within_arcsec=fitted.within_arcsec,
    )  # fmt: skip


def _squares(stars: Stars, names: tuple[str, ...], smooth: tuple[Smooth, ...]) -> float:
    rest = without(_design(stars, names, smooth), stars.left(names))
    return float(rest @ rest)


def _unknown(stars: Stars, names: tuple[str, ...], each: Smooth) -> Lack:
    """A dependence on a variable that is no term's: its rms over the stars."""
    design = _design(stars, names, (each,))
    values = np.linalg.lstsq(design, stars.left(names), rcond=None)[0]
    size = rms(each.columns @ values[len(names) :])
    return Lack(name="unknown", equivalent=(), over=each.over, arcsec=size, within_arcsec=None)


def _limits(stars: Stars, names: tuple[str, ...]) -> tuple[dict[str, float], tuple[str, ...]]:
    """Least sizes of terms not in the model that would have been significant; terms this sky hides."""
    design, residuals = stars.columns(names), stars.left(names)
    deviation = np.sqrt(residuals @ residuals / (len(residuals) - len(names)))
    unseen: dict[str, float] = {}
    confounded = []
    for name in (each for each in TERMS if each not in names):
        new = beside(stars.columns((name,))[:, 0], design)
        if new is None:
            confounded.append(name)
        else:
            unseen[name] = SIGNIFICANT * float(deviation / np.sqrt(new @ new))
    return unseen, tuple(confounded)
