"""One look over all candidates: quick scores, then full fits of the few best."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.channels.problem import Problem
from calibration.decide.refine import refine
from calibration.readers.run import Array
from calibration.statistics.regression import Fit, gls
from calibration.statistics.surrogate import orthonormal_blocks
from calibration.statistics.tails import chi2_log10

UNNAMED = 0.85  # a smooth function must beat a named effect clearly: it can imitate most of them
SURE = 4.0  # standard errors above zero for a coefficient that makes the effect what it is
CONTENDERS = 8  # candidates fitted in full, each with its own noise model


@dataclass(frozen=True)
class Contender:
    """A candidate fitted in full together with the base."""

    candidate: Candidate
    fit: Fit
    evidence: float  # -log10 p of the Wald test with block-robust covariance
    bayes: float  # log likelihood gain over the noise's design effect, less log(n)/2 per column
    gain: float  # log likelihood gain
    at: slice  # its columns in the fit


@dataclass(frozen=True)
class Look:
    """Result of one look: the fit without, and the best candidates with, best first."""

    null: Fit
    contenders: list[Contender]


def look(problem: Problem, base: Array, candidates: list[Candidate]) -> Look:
    """Rank every candidate on the training rows given `base`; fit the best ones in full."""
    null = gls(problem.y, base, problem.train, problem.ar_order, problem.block)
    if not candidates:
        return Look(null, [])
    share = _share(problem, null, base, candidates, True)
    chosen: list[Contender] = []
    seen: dict[object, int] = {}
    for k in np.argsort(-share):
        place = (candidates[k].key, candidates[k].domain)
        if seen.get(place, 0) >= 2 or (len(chosen) >= CONTENDERS and place in seen):
            continue
        found = fit_with(
            problem, base, refine(problem, base, null.residual, candidates[k], null.whitener), null
        )
        if found is not None:
            chosen.append(found)
            seen[place] = seen.get(place, 0) + 1
        if len(seen) >= CONTENDERS:
            break
    best: dict[object, Contender] = {}
    for c in sorted(chosen, key=lambda c: -c.bayes):
        best.setdefault(c.candidate.key, c)
    return Look(null, list(best.values()))


def _share(problem: Problem, null: Fit, base: Array, candidates: list[Candidate], white: bool) -> Array:
    """Share of the (whitened) residual that each candidate takes away, less what its columns take by
    chance."""
    train = problem.train
    x = np.hstack([c.columns for c in candidates])
    if white:
        use = null.whitener.usable(train)
        e = null.whitener.apply(np.where(train, null.residual, 0.0))[use]
        b = null.whitener.apply(np.where(train[:, None], base, 0.0))[use]
        x = null.whitener.apply(np.where(train[:, None], x, 0.0))[use]
    else:
        e, b, x = null.residual[train], base[train], x[train]
        e = e - b @ np.linalg.lstsq(b, e, rcond=None)[0] if b.shape[1] else e
    q, widths = orthonormal_blocks(x, b, [c.width for c in candidates])
    owner = np.repeat(np.arange(len(widths)), widths)
    taken = np.bincount(owner, (q.T @ e) ** 2, minlength=len(widths)) / max(float(np.sum(e**2)), 1e-300)
    return np.asarray(taken - 3.0 * np.array(widths) / len(e))


def fit_with(problem: Problem, base: Array, candidate: Candidate, null: Fit) -> Contender | None:
    """Fit base and candidate together; None when physics refuses the sign."""
    p = base.shape[1]
    fit = gls(problem.y, np.hstack([base, candidate.columns]), problem.train, problem.ar_order, problem.block)
    if not candidate.allowed(fit.beta[p:]):
        return None
    at = slice(p, p + candidate.width)
    for k in candidate.positive:
        if fit.beta[p + k] < SURE * float(np.sqrt(fit.covariance[p + k, p + k])):
            return None
    gain = fit.loglik - null.loglik * fit.rows / null.rows
    wald = float(fit.beta[at] @ np.linalg.pinv(fit.covariance[at, at], hermitian=True) @ fit.beta[at])
    evidence = float(chi2_log10(wald, candidate.width))
    effect = max(2 * gain / wald, 1.0) if wald > 0 else 1.0
    bayes = gain / effect - (candidate.width + candidate.searched) / 2 * float(np.log(fit.rows))
    if candidate.name == "unknown":
        bayes *= UNNAMED
    return Contender(candidate, fit, evidence, bayes if np.isfinite(evidence) else -np.inf, gain, at)
