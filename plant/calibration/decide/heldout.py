"""Errors on rows that were not fitted: before and after, raw and whitened, and whether a gain is more than
luck."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from plant.calibration.channels.problem import Problem
from plant.calibration.readers.run import Array
from plant.calibration.statistics.regression import solve
from plant.calibration.statistics.whitening import Mask, Whitener


@dataclass(frozen=True)
class HeldOut:
    """rms before and after on held-out rows (channel's unit) and the z-score of the whitened gain over
    blocks."""

    before: float
    after: float
    z: float
    share: float  # 1 - mean square after / before
    everywhere: bool = False  # cross-validation only: every fold gained


def predict_residual(problem: Problem, x: Array, beta: Array, rows: Mask) -> Array:
    """y - x beta on `rows`, with the fresh nuisances (offsets of a new segment) fitted there."""
    e = problem.y[rows] - x[rows] @ beta
    if problem.fresh is not None:
        f = problem.fresh[rows]
        e = e - f @ solve(f, e)
    return np.asarray(e)


def compare(
    problem: Problem, x0: Array, beta0: Array, x1: Array, beta1: Array, whitener: Whitener
) -> HeldOut:
    """Compare two fitted models on the held-out rows."""
    rows = problem.test
    if rows.sum() < 20:
        return HeldOut(float("nan"), float("nan"), 0.0, 0.0)
    e0, e1 = predict_residual(problem, x0, beta0, rows), predict_residual(problem, x1, beta1, rows)
    full0, full1 = np.zeros(len(problem.y)), np.zeros(len(problem.y))
    full0[rows], full1[rows] = e0, e1
    use = whitener.usable(rows)
    w0, w1 = whitener.apply(full0)[use], whitener.apply(full1)[use]
    z = paired_z(w0**2 - w1**2, problem.block)
    b, a = float(np.sqrt(np.mean(e0**2))), float(np.sqrt(np.mean(e1**2)))
    return HeldOut(b, a, z, 1 - (a / b) ** 2 if b > 0 else 0.0)


def paired_z(gain: Array, block: int) -> float:
    """z-score of the mean gain over blocks of rows."""
    if len(gain) < 2 * block:
        block = max(len(gain) // 4, 1)
    edges = np.arange(0, len(gain), block)
    sums = np.add.reduceat(gain, edges) if len(gain) else np.zeros(1)
    if len(sums) < 2 or np.std(sums) == 0:
        return 0.0
    return float(np.mean(sums) / (np.std(sums, ddof=1) / np.sqrt(len(sums))))


FOLDS = 5
FOLD_S = 6.0  # s per piece: pieces of one fold are spread over all runs


def cross_validate(problem: Problem, x0: Array, x1: Array, whitener: Whitener) -> HeldOut:
    """Score two designs on training rows they were not fitted to: pieces of FOLD_S dealt into FOLDS folds."""
    rows = problem.train
    use = whitener.usable(rows)
    if use.sum() < 100:
        return HeldOut(float("nan"), float("nan"), 0.0, 0.0)
    piece = np.floor(problem.t / max(FOLD_S, 8 * problem.period_s)).astype(np.int64)
    fold = (piece % FOLDS)[use]
    y = whitener.apply(np.where(rows, problem.y, 0.0))[use]
    left: list[Array] = []
    for x in (x0, x1):
        w = whitener.apply(np.where(rows[:, None], x, 0.0))[use]
        e = np.empty(len(y))
        for k in range(FOLDS):
            out = fold == k
            e[out] = y[out] - w[out] @ solve(w[~out], y[~out])
        left.append(e)
    e0, e1 = left
    b, a = float(np.sqrt(np.mean(e0**2))), float(np.sqrt(np.mean(e1**2)))
    gains = [float(np.sum((e0**2 - e1**2)[fold == k])) for k in range(FOLDS) if np.any(fold == k)]
    return HeldOut(
        b, a, paired_z(e0**2 - e1**2, problem.block), 1 - (a / b) ** 2 if b > 0 else 0.0, min(gains) > 0
    )
