"""Refinement of the parameters that enter a candidate nonlinearly (a time constant, an onset, a
resonance)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from plant.calibration.candidates.candidate import Candidate
from plant.calibration.channels.problem import Problem
from plant.calibration.readers.run import Array
from plant.calibration.statistics.whitening import Whitener

ROUNDS = 3  # of coordinate searches, each on a finer grid
POINTS = 7  # per coordinate and round


def refine(
    problem: Problem, base: Array, residual: Array, candidate: Candidate, whitener: Whitener
) -> Candidate:
    """Move the nonlinear parameters to where the candidate takes most off the residual (whitened, training
    rows)."""
    if candidate.shape is None:
        return candidate
    train = problem.train
    use = whitener.usable(train)
    e = whitener.apply(np.where(train, residual, 0.0))[use]
    b = whitener.apply(np.where(train[:, None], base, 0.0))[use]
    q, _ = np.linalg.qr(b / np.maximum(np.linalg.norm(b, axis=0), 1e-300))
    names = list(candidate.fixed)[: len(candidate.steps)]
    p = np.array([candidate.fixed[n][0] for n in names])
    shape = candidate.shape

    def taken(at: Array) -> float:
        x = whitener.apply(np.where(train[:, None], shape(at), 0.0))[use]
        x = x - q @ (q.T @ x)
        gram = x.T @ x
        if np.trace(gram) <= 0:
            return 0.0
        c = x.T @ e
        return float(c @ np.linalg.pinv(gram, rcond=1e-9) @ c)

    best = taken(p)
    reach = np.array(candidate.steps) * 3.0
    for _ in range(ROUNDS):
        for k in range(len(p)):
            for offset in np.linspace(-reach[k], reach[k], POINTS):
                trial = p.copy()
                trial[k] += offset
                value = taken(trial)
                if value > best:
                    best, p = value, trial
        reach /= 3.0
    fixed = dict(candidate.fixed)
    for n, v in zip(names, p, strict=True):
        fixed[n] = (float(v), fixed[n][1])
    return replace(candidate, columns=shape(p), fixed=fixed)


def slopes(candidate: Candidate, beta: Array) -> Array:
    """Columns d(columns beta)/d(parameter) of the nonlinear parameters, for their intervals; (n,
    len(steps))."""
    if candidate.shape is None:
        return np.zeros((candidate.columns.shape[0], 0))
    p = np.array([v for v, _ in candidate.fixed.values()])[: len(candidate.steps)]
    out = []
    for k, step in enumerate(candidate.steps):
        h = np.zeros(len(p))
        h[k] = 0.3 * step
        out.append((candidate.shape(p + h) - candidate.shape(p - h)) @ beta / (0.6 * step))
    return np.column_stack(out)
