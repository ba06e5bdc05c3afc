"""Acceptance of a contender beside the effects chosen before, and names that a log cannot tell from it."""

import numpy as np

from calibration.balances.problem import Problem
from calibration.decide import thresholds as limits
from calibration.decide.heldout import HeldOut, Model, compare, cross_validate
from calibration.decide.refine import never_begins
from calibration.decide.scan import Contender, fit_with
from calibration.decide.selection import Selection
from calibration.finding import UNKNOWN
from calibration.statistics.tails import wald_log10

SHORT = "the log is too short for it"
FEW = "too few rows to test it on"


def scores(others: Selection, contender: Contender) -> tuple[HeldOut, HeldOut]:
    """Of a contender beside `others`: on training rows it was not fitted to, and on the held-out rows."""
    p, w, beside = others.problem, contender.fit.whitener, _beside(others, contender)
    return cross_validate(p, others.columns, beside.x, w), compare(p, others.model, beside, w)


def _beside(others: Selection, one: Contender) -> Model:
    """`one` with the others, as it was fitted beside them."""
    x = np.hstack([others.columns, one.candidate.columns])
    return Model(x=x, beta=one.fit.beta, phases=others.problem.phases([*others.candidates, one.candidate]))


def refuse(contender: Contender, inside: HeldOut, held: HeldOut, margin: float, tried: int) -> str:
    """Why the scores of a contender, one of so many that were `tried`, do not let it in; empty when they do.

    An effect that the held-out run does not excite may gain nothing there, but none may make it worse.
    """
    if contender.bayes <= 0:
        return "gains less than its parameters cost"
    if not np.isfinite(inside.after):
        return FEW
    named = contender.candidate.name != UNKNOWN
    least = margin if named else max(limits.HANDICAP, margin)
    # a steady effect is in the noise's filter, which is made of what it leaves
    steady = inside.share > limits.NOISE_SHARE and inside.z > 2 * limits.LUCK_Z
    if inside.share < least and not (named and steady and held.share > limits.PLAINLY):
        by = f"{'falls' if inside.share > 0 else 'grows'} by {100 * abs(inside.share):.1f} %"
        return f"cross-validated mean square {by}{' only' if inside.share > 0 else ''}"
    if inside.z < limits.LUCK_Z and not (inside.everywhere and inside.share > limits.MARGIN):
        return f"cross-validated gain is within luck (z = {inside.z:.1f})"
    if not np.isfinite(held.after):
        return "no held-out rows to test it on"
    if held.share < -limits.ROUNDING:
        return f"makes the held-out mean square worse by {-100 * held.share:.1f} %"
    c = contender.candidate
    free = c.kind == "line" and c.stage is None  # the best of a spectrum
    least = c.least or needed(max(tried, limits.SPECTRUM) if free else tried)
    if named and held.apart and held.sure and held.share > limits.CLEAR_SHARE:
        least += limits.BY_HELD_OUT_ROWS
    if contender.evidence >= least:
        return ""
    times = next((k for k in range(2, limits.MOST_TIMES + 1) if contender.after(k) >= least), 0)
    if times and held.share > limits.MARGIN and held.sure:
        return (
            f"{SHORT}: it lowers the held-out mean square by {100 * held.share:.0f} %, but -log10 p is"
            f" {contender.evidence:.1f} of {least:.1f}. A log {times} times as long would decide."
        )
    return f"too little evidence (-log10 p = {contender.evidence:.1f})"


def needed(tried: int) -> float:
    """-log10 p that the best of so many candidates needs."""
    return limits.LEAST_EVIDENCE + float(np.log10(max(tried, 1)))


def least_share(p: Problem, tried: int) -> float:
    """The power of the log: the share of the fitted rows' mean square that one line needs for a name. So many
    are tried."""
    rows, blocks = int(p.train.sum()), p.train.sum() / p.block
    shares = np.arange(1, 100) / 100
    seen = wald_log10(rows * shares / (1 - shares), 2, blocks) >= needed(tried)
    return float(shares[np.argmax(seen)]) if seen.any() else 1.0


def too_small(others: Selection, contender: Contender, further: bool = True) -> str:
    """Why an effect is too small, or empty.

    It is within the sensor's steps, which a steady motion does not average out. Or it is a `further` one
    within the error of the effects chosen before, or a change that never begins.
    """
    p = others.problem
    fits = (others.before, others.after, contender.fit)
    plain, null, now = (float(np.mean(fit.residual[p.train] ** 2)) for fit in fits)
    found, taken = plain - null, null - now
    if taken < p.step**2:
        rms = f"{np.sqrt(max(taken, 0.0)):.2g} {p.unit} rms"
        return f"takes {rms} away, less than its columns are sure to ({p.step:.2g})"
    if further and taken < limits.MODEL_ERROR**2 * found:
        part = 100 * np.sqrt(max(taken, 0.0) / found)
        return f"takes {part:.1f} % of what the others take, which is within their own error"
    return never_begins(p, contender.candidate)


def equivalents(others: Selection, contenders: list[Contender], best: Contender) -> list[Contender]:
    """Contenders of another name that fit as well within the scatter over blocks (paired likelihoods).

    Those that held-out rows tell apart from the best are none of them.
    """
    out, first = [], best.candidate
    for rival in contenders:
        c = rival.candidate
        same = c.key == first.key or c.name == first.name == UNKNOWN
        # a richer form always fits as well
        if same or c.width > first.width or rival.gain < limits.RIVAL_GAIN * best.gain:
            continue
        loss, spread = _paired(others, best, rival)
        if loss < max(limits.PAIRED_LOSS, limits.LUCK_Z * spread):
            theirs, own = _beside(others, rival), _beside(others, best)
            out += [] if compare(others.problem, theirs, own, best.fit.whitener).sure else [rival]
    return out


def tied_at_last(s: Selection, k: int) -> list[Contender]:
    """What still ties with pick `k` beside all that was chosen in the end: its class was made before."""
    pick, p = s.chosen[k], s.problem
    own = [x for x in pick.confounded if x.candidate.key == pick.candidate.key]
    rivals = [x.candidate for x in pick.confounded if x.candidate.key != pick.candidate.key]
    if not rivals:
        return own
    others = s.without(k)
    best = fit_with(p, others.columns, pick.candidate)
    if best is None:
        return list(pick.confounded)
    again = (fit_with(p, others.columns, c, best.fit.whitener) for c in rivals)
    return [*own, *equivalents(others, [x for x in again if x is not None], best)]


def _paired(others: Selection, best: Contender, rival: Contender) -> tuple[float, float]:
    """Log likelihood lost by `rival`, and its standard error over blocks, in the best model's noise."""
    rows, w = others.problem.train, best.fit.whitener
    squares = [w.whiten(c.fit.residual, rows) ** 2 / (2 * best.fit.sigma**2) for c in (best, rival)]
    d = squares[1] - squares[0]
    sums = np.add.reduceat(d, np.arange(0, len(d), others.problem.block))
    return float(d.sum()), float(np.std(sums) * np.sqrt(len(sums)))
