"""A contender beside what is taken already, on rows it was not fitted to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.channels.problem import Problem
from calibration.decide.heldout import HeldOut, compare, cross_validate
from calibration.decide.scan import Contender, Look
from calibration.readers.run import Array
from calibration.statistics.regression import Fit, gls


@dataclass(frozen=True)
class Refusal:
    """A candidate that was looked at and refused, and why."""

    what: str
    why: str


def design(problem: Problem, chosen: list[Candidate]) -> Array:
    """Base and chosen candidates side by side."""
    return np.hstack([problem.base, *[c.columns for c in chosen]])


def phases(problem: Problem, chosen: list[Candidate]) -> list[slice]:
    """Columns of `design` whose phase is every run's own."""
    out, at = list(problem.base_phases), problem.base.shape[1]
    for c in chosen:
        if c.per_run:
            out.append(slice(at, at + c.width))
        at += c.width
    return out


def joint(problem: Problem, picks: list[Contender]) -> Fit:
    """All picks fitted together with the base."""
    return gls(
        problem.y,
        design(problem, [p.candidate for p in picks]),
        problem.train,
        problem.ar_order,
        problem.block,
    )


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
