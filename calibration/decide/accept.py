"""What is accepted, and what a log cannot tell from it."""

from __future__ import annotations

import numpy as np

from calibration.channels.problem import Problem
from calibration.decide.heldout import HeldOut
from calibration.decide.scan import Contender
from calibration.readers.run import Array
from calibration.statistics.regression import Fit

# of the cross-validated mean square; 2 % held the level on pure noise (effects.md, lesson 3), the rest is
MARGIN = 0.05
# for what a rigid balance misses of a compliant drive
LUCK = 2.0  # z of the cross-validated gain over blocks
NOISE = 0.02  # of the cross-validated mean square: that level (effects.md, lesson 3)
PLAINLY = 0.25  # of the held-out mean square, unfiltered (ASSUMPTION)
HANDICAP = 0.12  # of the mean square: an unnamed function must do more than a named one
LEAST_EVIDENCE = (
    10.0  # -log10 p of a candidate, beside the surrogate threshold: some 1e3 candidates are looked at
)
# of the mean square, gained in every fold: an effect that lives in a few bursts has a poor z over blocks
BURST = 0.05
# of a value, standard error: what the declared model itself is wrong by along a measured motion. From
# development logs, where estimates scatter by this much about the truth when noise alone would allow a tenth
MODEL_ERROR = 0.03
WORSE = 0.001  # of the held-out mean square: rounding, not harm
# of training rows: a covariance from fewer clusters is too small (the field's rule of thumb is 20 to 50), so
# short logs would be named with confidence they do not have
FEWEST_BLOCKS = 20


def refuse(contender: Contender, inside: HeldOut, held: HeldOut, margin: float = MARGIN) -> str:
    """Why a contender is not accepted; empty when it is.

    `inside` is its score on training rows it was not fitted to, `held` the one on the held-out rows: an
    effect that the
    held-out run does not excite may gain nothing there, but none may make it worse.
    """
    if contender.bayes <= 0:
        return "gains less than its parameters cost"
    if not np.isfinite(inside.after):
        return "too few rows to test it on"
    least = max(HANDICAP, margin) if contender.candidate.name == "unknown" else margin
    if contender.evidence < (contender.candidate.least or LEAST_EVIDENCE):
        return f"too little evidence (-log10 p = {contender.evidence:.1f})"
    if inside.share < least and not _plain(contender, inside, held):
        by = f"{'falls' if inside.share > 0 else 'grows'} by {100 * abs(inside.share):.1f} %"
        return f"cross-validated mean square {by}{' only' if inside.share > 0 else ''}"
    if inside.z < LUCK and not (inside.everywhere and inside.share > BURST):
        return f"cross-validated gain is within luck (z = {inside.z:.1f})"
    if not np.isfinite(held.after):
        return "no held-out rows to test it on"
    if held.share < -WORSE:
        return f"makes the held-out mean square worse by {-100 * held.share:.1f} %"
    return ""


def _plain(contender: Contender, inside: HeldOut, held: HeldOut) -> bool:
    """Whether a name that gains little behind the noise's filter takes much of the held-out error as it is: a
    steady effect is in the filter, which is made of what it leaves."""
    named = contender.candidate.name != "unknown"
    return named and inside.share > NOISE and inside.z > 2 * LUCK and held.share > PLAINLY


def within_step(problem: Problem, null: Fit, contender: Contender) -> str:
    """Why an effect is too small for the sensor's steps, which a steady motion does not average out; or
    empty."""
    rows = problem.train
    taken = float(np.mean(null.residual[rows] ** 2 - contender.fit.residual[rows] ** 2))
    if taken < problem.step**2:
        taken_rms = f"takes {np.sqrt(max(taken, 0.0)):.2g} {problem.unit} rms away"
        return f"{taken_rms}, less than its columns are sure to ({problem.step:.2g})"
    return ""


def within_model(problem: Problem, plain: Array, null: Fit, contender: Contender) -> str:
    """Why a further effect is too small beside those that are taken: their own shapes are wrong by as much;
    or empty. `plain` (n,) is what the declared terms alone leave."""
    rows = problem.train
    left = [float(np.mean(e[rows] ** 2)) for e in (plain, null.residual, contender.fit.residual)]
    others, taken = left[0] - left[1], left[1] - left[2]
    if taken < MODEL_ERROR**2 * others:
        part = 100 * np.sqrt(max(taken, 0.0) / others)
        return f"takes {part:.1f} % of what the others take, which is within their own error"
    return ""


def equivalents(problem: Problem, contenders: list[Contender], best: Contender) -> list[Contender]:
    """Contenders with another name that fit as well within the scatter over blocks (a paired likelihood
    test)."""
    out = []
    for other in contenders:
        if other.candidate.key == best.candidate.key or other.gain < 0.5 * best.gain:
            continue
        if other.candidate.name == best.candidate.name == "unknown":
            continue
        if other.candidate.width > best.candidate.width:
            continue  # a richer form always fits as well
        loss, spread = _paired(problem, best, other)
        if loss < max(2.0, 2.0 * spread):
            out.append(other)
    return out


def _paired(problem: Problem, best: Contender, other: Contender) -> tuple[float, float]:
    """Log likelihood lost by `other`, and its standard error over blocks, in the best model's noise."""
    w = best.fit.whitener
    rows = problem.train
    use = w.usable(rows)
    eb = w.apply(np.where(rows, best.fit.residual, 0.0))[use]
    eo = w.apply(np.where(rows, other.fit.residual, 0.0))[use]
    d = (eo**2 - eb**2) / (2 * best.fit.sigma**2)
    sums = np.add.reduceat(d, np.arange(0, len(d), problem.block))
    return float(d.sum()), float(np.std(sums) * np.sqrt(len(sums)))
