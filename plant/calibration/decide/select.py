"""Forward selection of effects in one channel, with out-of-run acceptance and re-tested earlier picks."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from plant.calibration.candidates.candidate import Candidate
from plant.calibration.channels.problem import Problem
from plant.calibration.decide.gate import gate
from plant.calibration.decide.heldout import HeldOut, compare, cross_validate
from plant.calibration.decide.scan import Contender, Look, fit_with, look
from plant.calibration.readers.run import Array
from plant.calibration.statistics.regression import Fit, gls
from plant.calibration.statistics.surrogate import Scores

# of the cross-validated mean square; 2 % held the level on pure noise (effects.md, lesson 3), the rest is
MARGIN = 0.05
# for what a rigid balance misses of a compliant drive
LUCK = 2.0  # z of the cross-validated gain over blocks
HANDICAP = 0.12  # of the mean square: an unnamed function must do more than a named one
LEAST_EVIDENCE = (
    10.0  # -log10 p of a candidate, beside the surrogate threshold: some 1e3 candidates are looked at
)
# of the mean square, gained in every fold: an effect that lives in a few bursts has a poor z over blocks
BURST = 0.05
WORSE = 0.001  # of the held-out mean square: rounding, not harm
MOST = 5  # effects per channel
# of training rows: a covariance from fewer clusters is too small (the field's rule of thumb is 20 to 50), so
# short logs would be named with confidence they do not have
FEWEST_BLOCKS = 20


@dataclass(frozen=True)
class Refusal:
    """A candidate that was looked at and refused, and why."""

    what: str
    why: str


@dataclass
class Selection:
    """What one channel says."""

    problem: Problem
    chosen: list[Contender]
    classes: list[list[Contender]]  # per chosen: those this log cannot separate from it
    before: Fit
    after: Fit
    held: HeldOut
    scores: Scores
    candidates: list[Candidate]
    refused: list[Refusal] = field(default_factory=list)
    steps: list[HeldOut] = field(default_factory=list)

    @property
    def statistic(self) -> float:
        """The largest score of all candidates."""
        return float(self.scores.value.max()) if len(self.scores.value) else 0.0


def design(problem: Problem, chosen: list[Candidate]) -> Array:
    """Base and chosen candidates side by side."""
    return np.hstack([problem.base, *[c.columns for c in chosen]])


def fitted(s: Selection) -> list[tuple[Candidate, Array]]:
    """Every accepted effect with its coefficients in the joint fit."""
    out, at = [], s.problem.base.shape[1]
    for c in s.chosen:
        out.append((c.candidate, s.after.beta[at : at + c.candidate.width]))
        at += c.candidate.width
    return out


def phases(problem: Problem, chosen: list[Candidate]) -> list[slice]:
    """Columns of `design` whose phase is every run's own."""
    out, at = [], problem.base.shape[1]
    for c in chosen:
        if c.per_run:
            out.append(slice(at, at + c.width))
        at += c.width
    return out


def judge(
    problem: Problem, look: Look, picks: list[Contender], contender: Contender
) -> tuple[HeldOut, HeldOut]:
    """Score a contender beside `picks`: on training rows it was not fitted to, and on the held-out rows."""
    others = [p.candidate for p in picks]
    base = design(problem, others)
    x, w = np.hstack([base, contender.candidate.columns]), contender.fit.whitener
    free = (phases(problem, others), phases(problem, [*others, contender.candidate]))
    inside = cross_validate(problem, base, x, w)
    return inside, compare(problem, base, look.null.beta, x, contender.fit.beta, w, free)


def select(
    problem: Problem,
    candidates: list[Candidate],
    rng: np.random.Generator,
    most: int = MOST,
    margin: float = MARGIN,
) -> Selection:
    """Pick effects one after another while each helps on held-out rows; then hold them against surrogates."""
    picks: list[Contender] = []
    classes: list[list[Contender]] = []
    steps: list[HeldOut] = []
    refused: list[Refusal] = []
    left = list(candidates)
    blocks = problem.train.sum() / problem.block
    if left and blocks < FEWEST_BLOCKS:
        refused.append(
            Refusal(
                "every candidate",
                f"{problem.train.sum() * problem.period_s:.0f} s to fit are {blocks:.0f} independent blocks,"
                f" an interval needs {FEWEST_BLOCKS}",
            )
        )
        left = []
    first: Look | None = None
    while len(picks) < most and left:
        base = design(problem, [p.candidate for p in picks])
        now = look(problem, base, left)
        first = first or now
        taken = None
        for contender in now.contenders[:4]:
            inside, held = judge(problem, now, picks, contender)
            why = refuse(contender, inside, held, margin) or within_step(problem, now.null, contender)
            if not why:
                taken = contender
                break
            refused.append(Refusal(contender.candidate.say(), why))
        if taken is None:
            break
        picks.append(taken)
        classes.append(equivalents(problem, now.contenders, taken))
        steps.append(held)
        picks, classes, steps = _retest(problem, picks, classes, steps, refused)
        left = [c for c in left if all(c.key != p.candidate.key for p in picks)]
    if len(picks) > 1:
        for k in range(len(picks)):
            _again(problem, picks, classes, steps, k, candidates, margin, refused)
    before = gls(problem.y, problem.base, problem.train, problem.ar_order, problem.block)
    after = _fit(problem, picks)
    scores = gate(problem, before, after, candidates, problem.base, rng)
    keep = [p.evidence >= scores.threshold for p in picks]
    for p, good in zip(picks, keep, strict=True):
        if not good:
            refused.append(
                Refusal(
                    p.candidate.say(),
                    f"below the surrogate threshold ({p.evidence:.1f} < {scores.threshold:.1f})",
                )
            )
    if not all(keep):
        picks = [x for x, k in zip(picks, keep, strict=True) if k]
        classes = [x for x, k in zip(classes, keep, strict=True) if k]
        steps = [x for x, k in zip(steps, keep, strict=True) if k]
        after = _fit(problem, picks)
    held = compare(
        problem,
        problem.base,
        before.beta,
        design(problem, [p.candidate for p in picks]),
        after.beta,
        after.whitener,
        ((), phases(problem, [p.candidate for p in picks])),
    )
    return Selection(problem, picks, classes, before, after, held, scores, candidates, refused, steps)


def _fit(problem: Problem, picks: list[Contender]) -> Fit:
    return gls(
        problem.y,
        design(problem, [p.candidate for p in picks]),
        problem.train,
        problem.ar_order,
        problem.block,
    )


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
    if contender.evidence < max(LEAST_EVIDENCE, contender.candidate.least):
        return f"too little evidence (-log10 p = {contender.evidence:.1f})"
    if inside.share < least:
        return f"cross-validated mean square changes by {-100 * inside.share:.1f} % only"
    if inside.z < LUCK and not (inside.everywhere and inside.share > BURST):
        return f"cross-validated gain is within luck (z = {inside.z:.1f})"
    if not np.isfinite(held.after):
        return "no held-out rows to test it on"
    if held.share < -WORSE:
        return f"makes the held-out mean square worse by {-100 * held.share:.1f} %"
    return ""


def within_step(problem: Problem, null: Fit, contender: Contender) -> str:
    """Why an effect is too small for the sensor's steps, which a steady motion does not average out; or
    empty."""
    rows = problem.train
    taken = float(np.mean(null.residual[rows] ** 2 - contender.fit.residual[rows] ** 2))
    if taken < problem.step**2:
        return f"takes {np.sqrt(max(taken, 0.0)):.2g} {problem.unit} rms away, less than a sensor's step"
    return ""


def _again(
    problem: Problem,
    picks: list[Contender],
    classes: list[list[Contender]],
    steps: list[HeldOut],
    k: int,
    candidates: list[Candidate],
    margin: float,
    refused: list[Refusal],
) -> None:
    """Look at pick `k` again beside all the others: what was taken while they were missing may be another's
    name."""
    others = [p for j, p in enumerate(picks) if j != k]
    base = design(problem, [p.candidate for p in others])
    taken = {p.candidate.key for p in others}
    now = look(problem, base, [c for c in candidates if c.key not in taken])
    for contender in now.contenders[:3]:
        inside, held = judge(problem, now, others, contender)
        if refuse(contender, inside, held, margin) or within_step(problem, now.null, contender):
            continue
        if contender.candidate.key != picks[k].candidate.key:
            refused.append(
                Refusal(picks[k].candidate.say(), f"{contender.candidate.say()} explains it better")
            )
        picks[k], steps[k] = contender, held
        classes[k] = equivalents(problem, now.contenders, contender)
        return


def _retest(
    problem: Problem,
    picks: list[Contender],
    classes: list[list[Contender]],
    steps: list[HeldOut],
    refused: list[Refusal],
) -> tuple[list[Contender], list[list[Contender]], list[HeldOut]]:
    """Drop earlier picks that the later ones made superfluous."""
    keep = list(range(len(picks)))
    for k in range(len(picks) - 1):
        others = design(problem, [picks[j].candidate for j in keep if j != k])
        null = gls(problem.y, others, problem.train, problem.ar_order, problem.block)
        again = fit_with(problem, others, picks[k].candidate, null)
        if again is None or again.bayes <= 0:
            keep.remove(k)
            refused.append(Refusal(picks[k].candidate.say(), "superfluous once the others are in"))
    return [picks[k] for k in keep], [classes[k] for k in keep], [steps[k] for k in keep]


def equivalents(problem: Problem, contenders: list[Contender], best: Contender) -> list[Contender]:
    """Contenders with another name that fit as well within the scatter over blocks (a paired likelihood
    test)."""
    out = []
    for other in contenders:
        if other.candidate.key == best.candidate.key or other.gain < 0.5 * best.gain:
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
