"""One look over all candidates: quick scores, then full fits of the few best."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.channels.problem import Problem
from calibration.decide.refine import refine
from calibration.readers.run import Array
from calibration.statistics.regression import Fit, gls, under
from calibration.statistics.surrogate import taken_away
from calibration.statistics.tails import chi2_log10
from calibration.statistics.whitening import Whitener

UNNAMED = 0.85  # a smooth function must beat a named effect clearly: it can imitate most of them
SURE = 4.0  # standard errors above zero for a coefficient that makes the effect what it is
# of its gain, that a line must gain beyond the stage's line next to it, to be another one (opened seeds
# 20261124 and 20261126; no stage's line of the development seeds 1020 to 1023 has a neighbour that does)
MORE = 0.05
ALIKE = 0.1  # of the mean square of what two add: more apart, they are two explanations (ASSUMPTION)
CONTENDERS = 8  # candidates fitted in full, each with its own noise model
COLUMNS = 32  # filtered and projected at once: what stays in a core's cache for 2e4 rows
PLAIN = 2  # of them at least from the ranking on the residual as it is


@dataclass(frozen=True)
class Contender:
    """A candidate fitted in full together with the base."""

    candidate: Candidate
    fit: Fit
    evidence: float  # -log10 p of the Wald test with block-robust covariance
    bayes: float  # log likelihood gain over the noise's design effect, less log(n)/2 per column
    gain: float  # log likelihood gain
    effect: float  # the noise's design effect: how much more the gain is than block-robust evidence allows
    at: slice  # its columns in the fit


@dataclass(frozen=True)
class Look:
    """Result of one look: the fit without, and the best candidates with, best first."""

    null: Fit
    contenders: list[Contender]


def look(problem: Problem, base: Array, candidates: list[Candidate]) -> Look:
    """Rank every candidate on the training rows given `base`; fit the best ones in full.

    The likelihoods of the best ones are then compared through one filter, that of the fit which leaves least.
    """
    null = gls(problem.y, base, problem.train, problem.ar_order, problem.block)
    if not candidates:
        return Look(null, [])
    fits: list[tuple[Candidate, Fit]] = []
    for k in _worth_fitting(problem, null, base, candidates):
        moved = refine(problem, base, null.residual, candidates[k], null.whitener)
        fit = _fit_beside(problem, base, moved)
        if fit is not None:
            fits.append((moved, fit))
    if not fits:
        return Look(null, [])
    common = max((fit for _, fit in fits), key=lambda f: f.loglik / f.rows).whitener
    without = under(problem.y, base, problem.train, common)
    chosen = [_scored(problem, base, c, fit, common, without) for c, fit in fits]
    order = ranked(chosen)
    beside = _neighbours(problem, base, null, order[0], without, common)
    best: dict[object, Contender] = {}
    for one in [*beside, *order]:
        best.setdefault(one.candidate.key, one)
    return Look(null, list(best.values()))


def _neighbours(
    problem: Problem, base: Array, null: Fit, first: Contender, without: float, common: Whitener
) -> list[Contender]:
    """Lines a little off the order of `first`, a stage's line, that gain clearly more than it does; beside a
    whole stage at once, which follows any line where the travel is hardly a turn, more than it costs."""
    whole = first.candidate.kind == "line" and first.candidate.harmonic is None
    out = []
    for candidate in first.candidate.neighbours:
        moved = refine(problem, base, null.residual, candidate, null.whitener)
        fit = _fit_beside(problem, base, moved)
        if fit is not None:
            one = _scored(problem, base, moved, fit, common, without)
            better = one.bayes > first.bayes if whole else one.gain > (1 + MORE) * first.gain
            out += [one] if better else []
    return sorted(out, key=lambda c: -c.gain)


def ranked(contenders: list[Contender]) -> list[Contender]:
    """Best first by `bayes`, except among those that say the same as the first (ALIKE): each one's design
    effect comes of its own covariance and differs by more than a coefficient costs."""
    left, out = sorted(contenders, key=lambda c: -c.bayes), []
    while left:
        alike = [c for c in left if np.isfinite(c.bayes) and _alike(c, left[0])]
        best = _best_of(left[0], alike or left[:1])
        out.append(best)
        left = [c for c in left if c is not best]
    return out


def _best_of(first: Contender, alike: list[Contender]) -> Contender:
    """The best form of the first's effect, by its design effect; or an effect with no more coefficients that
    gains more than that form by the filter they share, what a coefficient costs counted. A line is left
    alone: another line beside it has an order that was searched among thousands."""
    price = float(np.log(first.fit.rows)) / 2
    forms = [c for c in alike if c.candidate.key == first.candidate.key]
    form = max(forms, key=lambda c: c.gain / first.effect - price * c.candidate.cost)
    if form.candidate.kind == "line":
        return form
    others = [c for c in alike if c.candidate.cost <= form.candidate.cost and c.candidate.kind != "line"]
    return max(others, key=lambda c: c.gain - price * c.candidate.cost)


def _alike(one: Contender, other: Contender) -> bool:
    """Whether what two contenders add to the model is the same but for ALIKE of its mean square."""
    a, b = (c.candidate.columns @ c.fit.beta[c.at] for c in (one, other))
    return one is other or float(a @ b) ** 2 > (1 - ALIKE) * float(a @ a) * float(b @ b)


def _worth_fitting(problem: Problem, null: Fit, base: Array, candidates: list[Candidate]) -> list[int]:
    """Places of the candidates that are fitted in full: the best by the whitened residual, and PLAIN more by
    the plain one, because a filter fitted to a line's own residual takes the line away."""
    chosen: list[int] = []
    seen: dict[object, int] = {}
    for k in np.argsort(-_share(problem, null, base, candidates, True)):
        place = (candidates[k].key, candidates[k].domain)
        if seen.get(place, 0) >= 2 or (len(chosen) >= CONTENDERS and place in seen):
            continue
        chosen.append(int(k))
        seen[place] = seen.get(place, 0) + 1
        if len(seen) >= CONTENDERS:
            break
    if len(null.whitener.a):
        plain = [int(k) for k in np.argsort(-_share(problem, null, base, candidates, False))]
        chosen += [k for k in plain[:PLAIN] if k not in chosen]
    return chosen


def _share(problem: Problem, null: Fit, base: Array, candidates: list[Candidate], white: bool) -> Array:
    """Share of the (whitened) residual that each candidate takes away, less what its columns take by
    chance."""
    train = problem.train
    use = null.whitener.usable(train) if white else train

    def rows(x: Array) -> Array:
        if white:
            x = null.whitener.apply(np.where(train if x.ndim == 1 else train[:, None], x, 0.0))
        return np.asarray(x[use])

    e = rows(null.residual)
    taken, widths = [], []
    for some in _few(candidates):
        part, width = taken_away(e, rows(base), [rows(c.columns) for c in some])
        taken += part
        widths += width
    share = np.array(taken) / max(float(np.sum(e**2)), 1e-300)
    return np.asarray(share - 3.0 * np.array(widths) / len(e))


def _few(candidates: list[Candidate]) -> list[list[Candidate]]:
    """Candidates in groups of some COLUMNS columns."""
    ends = np.cumsum([c.width for c in candidates]) // COLUMNS
    return [[c for c, k in zip(candidates, ends, strict=True) if k == g] for g in np.unique(ends)]


def fit_with(problem: Problem, base: Array, candidate: Candidate) -> Contender | None:
    """Fit base and candidate together; None when physics refuses the sign."""
    fit = _fit_beside(problem, base, candidate)
    if fit is None:
        return None
    without = under(problem.y, base, problem.train, fit.whitener)
    return _scored(problem, base, candidate, fit, fit.whitener, without)


def _fit_beside(problem: Problem, base: Array, candidate: Candidate) -> Fit | None:
    p = base.shape[1]
    fit = gls(problem.y, np.hstack([base, candidate.columns]), problem.train, problem.ar_order, problem.block)
    if not candidate.allowed(fit.beta[p:]):
        return None
    for k in candidate.positive:
        if fit.beta[p + k] < SURE * float(np.sqrt(fit.covariance[p + k, p + k])):
            return None
    return fit


def _scored(
    problem: Problem, base: Array, candidate: Candidate, fit: Fit, common: Whitener, without: float
) -> Contender:
    """The contender's evidence from its own fit, its gain from the likelihoods through the filter `common`,
    through which the base alone has `without`."""
    at = slice(base.shape[1], base.shape[1] + candidate.width)
    columns = np.hstack([base, candidate.columns])
    gain = under(problem.y, columns, problem.train, common) - without
    wald = float(fit.beta[at] @ np.linalg.pinv(fit.covariance[at, at], hermitian=True) @ fit.beta[at])
    evidence = float(chi2_log10(wald, candidate.width))
    effect = max(2 * gain / wald, 1.0) if wald > 0 else 1.0
    bayes = _bayes(candidate, gain / effect, fit.rows)
    return Contender(candidate, fit, evidence, bayes if np.isfinite(evidence) else -np.inf, gain, effect, at)


def _bayes(candidate: Candidate, gain: float, rows: int) -> float:
    """`gain` less log(n)/2 for every coefficient and every parameter that was searched for."""
    bayes = gain - candidate.cost / 2 * float(np.log(rows))
    return bayes * UNNAMED if candidate.name == "unknown" and candidate.width > 1 else bayes
