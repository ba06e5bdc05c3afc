"""What was taken and should not stay: beside what came later it is needless, or of an impossible size."""

from __future__ import annotations

import numpy as np

from calibration.channels.problem import Problem
from calibration.decide.accept import refuse
from calibration.decide.heldout import HeldOut
from calibration.decide.judge import Refusal, design, joint, judge
from calibration.decide.scan import Contender, Look, fit_with
from calibration.statistics.regression import gls


def without_superfluous(
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
        again = fit_with(problem, others, picks[k].candidate)
        if again is None or again.bayes <= 0:
            keep.remove(k)
            refused.append(Refusal(picks[k].candidate.say(), "superfluous once the others are in"))
    return [picks[k] for k in keep], [classes[k] for k in keep], [steps[k] for k in keep]


def drop_needless(
    problem: Problem,
    picks: list[Contender],
    classes: list[list[Contender]],
    steps: list[HeldOut],
    margin: float,
    refused: list[Refusal],
) -> None:
    """Drop the unnamed functions that would not be taken beside what else was found: a smooth function stands
    for part of an effect until that has its name, and then for what its shape leaves."""
    for k in reversed(range(len(picks))):
        others = [p for j, p in enumerate(picks) if j != k]
        if picks[k].candidate.name != "unknown" or not others:
            continue
        base = design(problem, [p.candidate for p in others])
        again = fit_with(problem, base, picks[k].candidate)
        null = gls(problem.y, base, problem.train, problem.ar_order, problem.block)
        why = ""
        if again is not None:
            inside, held = judge(problem, Look(null, [again]), others, again)
            why = refuse(again, inside, held, margin)
        if again is None or why:
            refused.append(Refusal(picks[k].candidate.say(), f"beside the others: {why or 'cannot be told'}"))
            del picks[k], classes[k], steps[k]


def unphysical(problem: Problem, picks: list[Contender]) -> int | None:
    """Place of an effect whose size in the joint fit its own bounds exclude; None where all are within."""
    beta, at = joint(problem, picks).beta, problem.base.shape[1]
    for k, pick in enumerate(picks):
        here = beta[at : at + pick.candidate.width]
        some = pick.candidate.sign and np.any(here * pick.candidate.sign > 0)  # may lose a part: prune.signed
        if not pick.candidate.allowed(here) and not some:
            return k
        at += pick.candidate.width
    return None
