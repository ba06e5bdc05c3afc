"""One look over all candidates: quick scores, then full fits of the few best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from calibration.arrays import Array
from calibration.balances.candidate import Candidate
from calibration.balances.problem import Problem
from calibration.decide import thresholds as limits
from calibration.decide.heldout import HeldOut
from calibration.decide.refine import Rest, refine
from calibration.finding import UNKNOWN
from calibration.statistics.regression import Fit, under
from calibration.statistics.surrogate import basis, taken_away
from calibration.statistics.tails import wald_log10
from calibration.statistics.thresholds import SURE_Z
from calibration.statistics.whitening import Whitener

Fitted = tuple[Candidate, Fit]


@dataclass(frozen=True, kw_only=True, eq=False)
class Contender:
    """A candidate fitted in full; once accepted, with its held-out gain and what ties with it."""

    candidate: Candidate
    fit: Fit
    wald: float  # of its coefficients, with block-robust covariance
    blocks: float  # independent ones, that the covariance is made of
    bayes: float  # log likelihood gain over the noise's design effect, less log(n)/2 per column
    gain: float  # log likelihood gain
    effect: float  # the noise's design effect: how much more the gain is than block-robust evidence allows
    at: slice  # its columns in the fit
    held: HeldOut = field(default_factory=HeldOut)
    confounded: Sequence[Contender] = ()

    @property
    def evidence(self) -> float:
        """-log10 p of the Wald test."""
        return self.after(1)

    def after(self, times: int) -> float:
        """The evidence of so many such logs."""
        return float(wald_log10(times * self.wald, self.at.stop - self.at.start, times * self.blocks))


def look(p: Problem, base: Array, null: Fit, candidates: list[Candidate]) -> list[Contender]:
    """Rank candidates on training rows beside `base`, whose fit is `null`; the best, fitted in full, first.

    The likelihoods of the best ones are then compared through one filter, that of the fit which leaves least.
    """
    worth = [candidates[k] for k in _worth_fitting(p, null, base, candidates)]
    fits = _fits_beside(p, base, null, worth)
    if not fits:
        return []
    common = max((fit for _, fit in fits), key=lambda f: f.loglik / f.rows).whitener
    without = under(p.y, base, p.train, common)
    order = ranked([_scored(p, base, c, fit, common, without) for c, fit in fits])
    beside = _neighbours(p, base, null, order[0], without, common)
    forms: dict[object, list[Contender]] = {}
    for one in [*beside, *order]:
        forms.setdefault(one.candidate.key, []).append(one)
    return [_first_of_class(alike) for alike in forms.values()]


def _first_of_class(forms: list[Contender]) -> Contender:
    """The best form of an effect; of places that tie exactly the first, with the others as confounded."""
    best = forms[0]
    elsewhere = (c for c in forms if c.candidate.place != best.candidate.place)
    tied = [c for c in elsewhere if abs(c.gain - best.gain) < limits.TIE]
    first, *others = sorted([best, *tied], key=lambda c: sorted(c.candidate.place.items()))
    return replace(first, confounded=others)


def _neighbours(
    p: Problem, base: Array, null: Fit, first: Contender, without: float, common: Whitener
) -> list[Contender]:
    """Lines a little off the order of `first` that gain clearly more. Beside a whole stage at once, which
    follows any line over hardly a turn, they gain more than they cost."""
    whole = first.candidate.kind == "line" and first.candidate.harmonic is None
    fits = _fits_beside(p, base, null, first.candidate.neighbours)
    tried = [_scored(p, base, c, fit, common, without) for c, fit in fits]
    better = [c for c in tried if c.gain > (1 + limits.MORE) * first.gain]
    return sorted([c for c in tried if c.bayes > first.bayes] if whole else better, key=lambda c: -c.gain)


def ranked(contenders: list[Contender]) -> list[Contender]:
    """Best first by `bayes`, but among those that say the same (SAME_SHAPE), as design effects scatter."""
    left, out = sorted(contenders, key=lambda c: -c.bayes), []
    while left:
        alike = [c for c in left if np.isfinite(c.bayes) and _alike(c, left[0])]
        best = _best_of(left[0], alike or left[:1])
        out.append(best)
        left = [c for c in left if c is not best]
    return out


def _best_of(first: Contender, alike: list[Contender]) -> Contender:
    """The best form of the first's effect, by its design effect; or an effect with no more coefficients that
    gains more by the shared filter. A line's order was searched among thousands: it is left alone."""
    price = float(np.log(first.fit.rows)) / 2
    forms = [c for c in alike if c.candidate.key == first.candidate.key]
    form = max(forms, key=lambda c: c.gain / first.effect - price * c.candidate.cost)
    if form.candidate.kind == "line":
        return form
    others = [c for c in alike if c.candidate.cost <= form.candidate.cost and c.candidate.kind != "line"]
    return max(others, key=lambda c: c.gain - price * c.candidate.cost)


def _alike(one: Contender, other: Contender) -> bool:
    """Whether what two contenders add to the model is the same but for SAME_SHAPE of its mean square."""
    a, b = (c.candidate.columns @ c.fit.beta[c.at] for c in (one, other))
    return one is other or float(a @ b) ** 2 > (1 - limits.SAME_SHAPE) * float(a @ a) * float(b @ b)


def _worth_fitting(p: Problem, null: Fit, base: Array, candidates: list[Candidate]) -> list[int]:
    """Places of candidates fitted in full: the best by the whitened residual, some by the plain one."""
    chosen: list[int] = []
    seen: dict[object, int] = {}
    for k in np.argsort(-_share(p, null, base, candidates, True)):
        place = (candidates[k].key, candidates[k].domain)
        full = len(chosen) >= limits.CONTENDERS and place in seen
        if full or seen.get(place, 0) >= limits.FORMS_PER_EFFECT:
            continue
        chosen.append(int(k))
        seen[place] = seen.get(place, 0) + 1
        if len(seen) >= limits.CONTENDERS:
            break
    if len(null.whitener.a):
        plain = [int(k) for k in np.argsort(-_share(p, null, base, candidates, False))]
        chosen += [k for k in plain[: limits.PLAIN_CONTENDERS] if k not in chosen]
    return chosen


def _share(p: Problem, null: Fit, base: Array, candidates: list[Candidate], white: bool) -> Array:
    """Share of the (whitened) residual that each candidate takes, less what chance takes."""
    train = p.train

    def rows(x: Array) -> Array:
        return null.whitener.whiten(x, train) if white else np.asarray(x[train])

    e, q = rows(null.residual), basis(rows(base))
    taken, widths = [], []
    for some in few(candidates):
        part, width = taken_away(e, q, [rows(c.columns) for c in some])
        taken += part
        widths += width
    share = np.array(taken) / max(float(np.sum(e**2)), 1e-300)
    return np.asarray(share - limits.COLUMN_PRICE * np.array(widths) / len(e))


def few(candidates: list[Candidate]) -> list[list[Candidate]]:
    """Candidates in groups of some SCAN_COLUMNS columns."""
    ends = np.cumsum([c.width for c in candidates]) // limits.SCAN_COLUMNS
    return [[c for c, k in zip(candidates, ends, strict=True) if k == g] for g in np.unique(ends)]


def fit_with(
    p: Problem, base: Array, candidate: Candidate, through: Whitener | None = None
) -> Contender | None:
    """Base and candidate fitted together, scored `through` a filter or its own; None of a refused sign."""
    fit = _fit_beside(p, base, candidate)
    if fit is None:
        return None
    common = through or fit.whitener
    return _scored(p, base, candidate, fit, common, under(p.y, base, p.train, common))


def _fits_beside(p: Problem, base: Array, null: Fit, some: Sequence[Candidate]) -> list[Fitted]:
    """Candidates refined and fitted in full, but for those that physics refuses."""
    rest = Rest(p.train, base, null.residual, null.whitener)
    moved = (refine(rest, c) for c in some)
    return [(c, fit) for c in moved if (fit := _fit_beside(p, base, c)) is not None]


def _fit_beside(p: Problem, base: Array, c: Candidate) -> Fit | None:
    n = base.shape[1]
    fit = p.fit(np.hstack([base, c.columns]))
    positive = (n + k for k in c.positive)
    sure = all(fit.beta[k] >= SURE_Z * fit.errors[k] for k in positive)
    return fit if sure and c.allowed(fit.beta[n:]) else None


def _scored(p: Problem, base: Array, c: Candidate, fit: Fit, common: Whitener, without: float) -> Contender:
    """Evidence from its own fit, gain through the filter `common`, by which the base has `without`."""
    at = slice(base.shape[1], base.shape[1] + c.width)
    gain = under(p.y, np.hstack([base, c.columns]), p.train, common) - without
    wald = float(fit.beta[at] @ np.linalg.pinv(fit.covariance[at, at], hermitian=True) @ fit.beta[at])
    effect = max(2 * gain / wald, 1.0) if wald > 0 else 1.0
    # less log(n)/2 for every coefficient and every parameter that was searched for
    bayes = gain / effect - c.cost / 2 * float(np.log(fit.rows))
    bayes *= limits.UNNAMED if c.name == UNKNOWN and c.width > 1 else 1.0
    return Contender(
        candidate=c,
        fit=fit,
        wald=wald,
        blocks=fit.rows / p.block,
        bayes=bayes if np.isfinite(wald) else -np.inf,
        gain=gain,
        effect=effect,
        at=at,
    )
