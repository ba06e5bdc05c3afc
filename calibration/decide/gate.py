"""The gate: is anything there at all? The largest score of all candidates against surrogates of the
residual."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.channels.problem import Problem
from calibration.readers.run import Array
from calibration.statistics.regression import Fit
from calibration.statistics.surrogate import Scores, orthonormal_blocks, score, together

DRAWS = 400  # surrogates
COLUMNS = 64  # filtered and projected at once
LEVEL = 0.99  # of the surrogate maximum; aim: at most 1 % false alarms


def gate(
    problem: Problem,
    null: Fit,
    final: Fit,
    candidates: list[Candidate],
    base: Array,
    rng: np.random.Generator,
) -> Scores:
    """Scores of all candidates on the residual of `null`, thresholds from surrogates of the residual of
    `final`."""
    if not candidates:
        return Scores(np.zeros(0), np.zeros(0), 0.0, np.zeros(DRAWS))
    train, w = problem.train, final.whitener
    use = w.usable(train)
    e = w.apply(np.where(train, null.residual, 0.0))[use]
    noise = w.apply(np.where(train, final.residual, 0.0))[use]
    b = w.apply(np.where(train[:, None], base, 0.0))[use]
    edges = len(range(0, len(e), problem.block))
    signs = rng.choice([-1.0, 1.0], size=(DRAWS, edges))
    parts = []
    for some in _handfuls(candidates):  # all at once would be the largest array of the whole analysis
        x = w.apply(np.where(train[:, None], np.hstack([c.columns for c in some]), 0.0))[use]
        q, widths = orthonormal_blocks(x, b, [c.width for c in some])
        parts.append(score(e, noise, q, widths, problem.block, signs))
    return together(parts, LEVEL)


def _handfuls(candidates: list[Candidate]) -> list[list[Candidate]]:
    """The candidates in their order, some COLUMNS columns at a time."""
    out: list[list[Candidate]] = [[]]
    for c in candidates:
        if sum(x.width for x in out[-1]) >= COLUMNS:
            out.append([])
        out[-1].append(c)
    return out
