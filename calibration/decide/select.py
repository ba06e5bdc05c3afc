"""Forward selection of effects in one channel, with out-of-run acceptance and re-tested earlier picks."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.channels.problem import Problem
from calibration.decide.accept import FEWEST_BLOCKS, MARGIN, equivalents, refuse, within_model, within_step
from calibration.decide.gate import gate
from calibration.decide.heldout import HeldOut, compare
from calibration.decide.judge import Refusal, design, joint, judge, phases
from calibration.decide.refine import polish
from calibration.decide.sameorder import lesser_of_one_order
from calibration.decide.scan import Contender, fit_with, look
from calibration.decide.superfluous import drop_needless, unphysical, without_superfluous
from calibration.decide.unseen import never_begins, settled
from calibration.readers.run import Array
from calibration.statistics.regression import Fit, gls, under
from calibration.statistics.surrogate import Scores

MOST = 5  # effects per channel
ROWS_PER_COLUMN = 8  # before a fit on a short log is tried at all
CLOSEST = "the closest candidate"


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
    looked_at: int  # candidates: their columns are the largest arrays, and are not kept
    refused: list[Refusal] = field(default_factory=list)
    steps: list[HeldOut] = field(default_factory=list)

    @property
    def statistic(self) -> float:
        """The largest score of all candidates."""
        return float(self.scores.value.max()) if len(self.scores.value) else 0.0


def fitted(s: Selection) -> list[tuple[Candidate, Array]]:
    """Every accepted effect with its coefficients in the joint fit."""
    out, at = [], s.problem.base.shape[1]
    for c in s.chosen:
        out.append((c.candidate, s.after.beta[at : at + c.candidate.width]))
        at += c.candidate.width
    return out


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
        need = FEWEST_BLOCKS * problem.block * problem.period_s
        why = (
            f"{problem.train.sum() * problem.period_s:.0f} s to fit are {blocks:.0f} independent blocks,"
            f" an interval needs {FEWEST_BLOCKS} ({need:.0f} s)"
        )
        refused += [Refusal("every candidate", why), *_closest(problem, left)]
        left = []
    plain = left_by_base(problem)
    while len(picks) < most and left:
        base = design(problem, [p.candidate for p in picks])
        now = look(problem, base, left)
        taken = None
        for one in now.contenders[:4]:
            contender = settled(problem, base, one)
            inside, held = judge(problem, now, picks, contender)
            why = refuse(contender, inside, held, margin) or within_step(problem, now.null, contender)
            why = why or within_model(problem, plain, now.null, contender)
            why = why or never_begins(problem, contender.candidate)
            if not why:
                taken = contender
                break
            refused.append(Refusal(contender.candidate.say(), why))
        if taken is None:
            break
        picks.append(taken)
        classes.append(equivalents(problem, now.contenders, taken))
        steps.append(held)
        picks, classes, steps = without_superfluous(problem, picks, classes, steps, refused)
        left = [c for c in left if all(c.key != p.candidate.key for p in picks)]
    if len(picks) > 1:
        for k in range(len(picks)):
            _again(problem, picks, classes, steps, k, candidates, margin, refused)
        drop_needless(problem, picks, classes, steps, margin, refused)
    while (lesser := lesser_of_one_order(problem, [p.candidate for p in picks])) is not None:
        k, other = lesser
        why = f"its order is that of {picks[other].candidate.say()}, whose shape leaves as much"
        refused.append(Refusal(picks[k].candidate.say(), why))
        del picks[k], classes[k], steps[k]
    for k in range(len(picks)):
        _polish(problem, picks, k)
    before = gls(problem.y, problem.base, problem.train, problem.ar_order, problem.block)
    while (bad := unphysical(problem, picks)) is not None:
        why = "beside the others its size comes out with a sign that physics excludes"
        refused.append(Refusal(picks[bad].candidate.say(), why))
        del picks[bad], classes[bad], steps[bad]
    after = joint(problem, picks)
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
        after = joint(problem, picks)
    held = compare(
        problem,
        problem.base,
        before.beta,
        design(problem, [p.candidate for p in picks]),
        after.beta,
        after.whitener,
        (problem.base_phases, phases(problem, [p.candidate for p in picks])),
    )
    return Selection(problem, picks, classes, before, after, held, scores, len(candidates), refused, steps)


def left_by_base(problem: Problem) -> Array:
    """What the declared terms alone leave, (n,)."""
    return gls(problem.y, problem.base, problem.train, problem.ar_order, problem.block).residual


def _closest(problem: Problem, candidates: list[Candidate]) -> list[Refusal]:
    """The candidate that would have been looked at first, had the rows been enough."""
    room = problem.base.shape[1] + max(c.width for c in candidates)
    if problem.train.sum() < ROWS_PER_COLUMN * room:
        return []
    now = look(problem, problem.base, candidates).contenders[:1]
    return [
        Refusal(c.candidate.say(), f"{CLOSEST} (-log10 p = {c.evidence:.1f}), but too few rows to name it")
        for c in now
        if c.bayes > 0
    ]


def _polish(problem: Problem, picks: list[Contender], k: int) -> None:
    """Move pick `k`'s nonlinear parameters together, beside the others."""
    if len(picks[k].candidate.steps) < 2:
        return
    base = design(problem, [p.candidate for j, p in enumerate(picks) if j != k])
    null = gls(problem.y, base, problem.train, problem.ar_order, problem.block)
    better = polish(problem, base, null.residual, picks[k].candidate, picks[k].fit.whitener)
    found = fit_with(problem, base, better)
    if found is None:
        return
    common = found.fit.whitener
    now, was = (
        under(problem.y, np.hstack([base, c.columns]), problem.train, common)
        for c in (found.candidate, picks[k].candidate)
    )
    picks[k] = settled(problem, base, found if now > was else picks[k])


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
    for one in now.contenders[:3]:
        contender = settled(problem, base, one)
        inside, held = judge(problem, now, others, contender)
        if refuse(contender, inside, held, margin) or within_step(problem, now.null, contender):
            continue
        if never_begins(problem, contender.candidate):
            continue
        if contender.candidate.key != picks[k].candidate.key:
            refused.append(
                Refusal(picks[k].candidate.say(), f"{contender.candidate.say()} explains it better")
            )
        picks[k], steps[k] = contender, held
        classes[k] = equivalents(problem, now.contenders, contender)
        return
