"""Refinement of the parameters that enter a candidate nonlinearly (a time constant, an onset, a
resonance)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.channels.problem import Problem
from calibration.readers.run import Array
from calibration.statistics.whitening import Whitener

ROUNDS = 3  # of coordinate searches, each on a finer grid
EVALUATIONS = 90  # of the joint search
POINTS = 7  # per coordinate and round


def refine(
    problem: Problem, base: Array, residual: Array, candidate: Candidate, whitener: Whitener
) -> Candidate:
    """Move the nonlinear parameters to where the candidate takes most off the residual (whitened, training
    rows)."""
    if candidate.shape is None:
        return candidate
    names = list(candidate.fixed)[: len(candidate.steps)]
    p = np.array([candidate.fixed[n][0] for n in names])
    taken = _taken(problem, base, residual, candidate, whitener)
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
    return _moved(candidate, p)


def polish(
    problem: Problem, base: Array, residual: Array, candidate: Candidate, whitener: Whitener
) -> Candidate:
    """Move nonlinear parameters that depend on each other (an onset and a ramp, a frequency and its damping)
    together; for the few candidates that were chosen."""
    if candidate.shape is None or len(candidate.steps) < 2:
        return candidate
    from scipy.optimize import minimize

    taken = _taken(problem, base, residual, candidate, whitener)
    p = np.array([v for v, _ in candidate.fixed.values()])[: len(candidate.steps)]
    corners = np.vstack([p, *(p + np.eye(len(p)) * np.array(candidate.steps))])
    found = minimize(
        lambda q: -taken(q),
        p,
        method="Nelder-Mead",
        options={"initial_simplex": corners, "maxfev": EVALUATIONS, "fatol": 1e-6, "xatol": 1e-6},
    )
    return _moved(candidate, found.x) if -found.fun > taken(p) else candidate


def _taken(
    problem: Problem, base: Array, residual: Array, candidate: Candidate, whitener: Whitener
) -> Callable[[Array], float]:
    """What the candidate takes off the whitened residual of the training rows, over its nonlinear
    parameters."""
    train = problem.train
    use = whitener.usable(train)
    e = whitener.apply(np.where(train, residual, 0.0))[use]
    b = whitener.apply(np.where(train[:, None], base, 0.0))[use]
    q, _ = np.linalg.qr(b / np.maximum(np.linalg.norm(b, axis=0), 1e-300))
    shape = candidate.shape
    assert shape is not None

    def taken(at: Array) -> float:
        x = whitener.apply(np.where(train[:, None], shape(at), 0.0))[use]
        x = x - q @ (q.T @ x)
        gram = x.T @ x
        if np.trace(gram) <= 0:
            return 0.0
        c = x.T @ e
        if len(c) == 1:
            return float(c[0] ** 2 / gram[0, 0])
        return float(c @ np.linalg.pinv(gram, rcond=1e-9, hermitian=True) @ c)

    return taken


def _moved(candidate: Candidate, p: Array) -> Candidate:
    """The candidate at nonlinear parameters `p`."""
    assert candidate.shape is not None
    fixed = dict(candidate.fixed)
    for n, v in zip(list(fixed)[: len(p)], p, strict=True):
        fixed[n] = (float(v), fixed[n][1])
    return replace(candidate, columns=candidate.shape(p), fixed=fixed)


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
