"""Two names at one order: what the lesser adds must be more than the greater's own shape leaves.

A line's columns know the motor's angle, its speed and its current only so well. What that leaves of a line
has its order, and another name of the same order takes it for its own: ripple beside cogging, a motor's
harmonic beside a tooth.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.channels.problem import Problem
from calibration.decide.scan import MORE
from calibration.readers.run import Array
from calibration.statistics.regression import gls, under

SAME = 1e-6  # of an order: two stages that mesh turn in whole ratios


def lesser_of_one_order(problem: Problem, picks: list[Candidate]) -> tuple[int, int] | None:
    """Places of a pick that gains less than MORE of what another one of its order gains, and of that one."""
    pairs = [(i, j) for i in range(len(picks)) for j in range(i) if _same(picks[i], picks[j])]
    if not pairs:
        return None
    gain = _likelihood(problem, picks)
    for i, j in pairs:
        both, alone = gain({i, j}), (gain({i}), gain({j}))
        lesser, greater = (i, j) if alone[0] >= alone[1] else (j, i)
        kept = max(alone)
        if gain(set()) - kept < MORE * (kept - both):
            return lesser, greater
    return None


def _same(one: Candidate, other: Candidate) -> bool:
    if one.order is None or other.order is None or one.name == other.name:
        return False
    return abs(one.order - other.order) < SAME * abs(one.order)


def _likelihood(problem: Problem, picks: list[Candidate]) -> Callable[[set[int]], float]:
    """Log likelihood of all picks but those at the given places, through the filter of the fit of all."""

    def columns(without: set[int]) -> Array:
        return np.hstack([problem.base, *[c.columns for k, c in enumerate(picks) if k not in without]])

    whitener = gls(problem.y, columns(set()), problem.train, problem.ar_order, problem.block).whitener
    return lambda without: under(problem.y, columns(without), problem.train, whitener)
