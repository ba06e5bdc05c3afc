"""Errors on rows that were not fitted: before and after, raw and whitened, and whether a gain is more than
luck."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.channels.problem import Problem
from calibration.readers.run import Array
from calibration.statistics.regression import leverage, solve
from calibration.statistics.whitening import Mask, Whitener


@dataclass(frozen=True)
class HeldOut:
    """rms before and after on held-out rows (channel's unit) and the z-score of the whitened gain over
    blocks."""

    before: float
    after: float
    z: float
    share: float  # 1 - mean square after / before
    everywhere: bool = False  # cross-validation only: every fold gained


def predict_residual(
    problem: Problem, x: Array, beta: Array, rows: Mask, phases: Sequence[slice] = ()
) -> Array:
    """y - x beta on `rows`, with the fresh nuisances fitted there: offsets of a new segment, and of the
    columns in `phases` the phase of a run that training has not seen."""
    e = problem.y[rows] - x[rows] @ beta
    for at in phases:
        e = e - _new_phase(x[:, at], beta[at], problem.train, rows, e)
    if problem.fresh is not None:
        f = problem.fresh[rows]
        e = e - f @ solve(f, e)
    return np.asarray(e)


def _new_phase(pairs: Array, beta: Array, train: Mask, rows: Mask, e: Array) -> Array:
    """What lines of known amplitude and a phase of their own in every run (cos, sin per run) take off `e`
    there; the j-th pair of every run is the same harmonic."""
    known: dict[int, list[float]] = {}
    fresh: list[tuple[int, int]] = []
    seen: dict[int, int] = {}
    for k in range(0, pairs.shape[1] - 1, 2):
        pair = pairs[:, k : k + 2]
        begin = int(np.argmax(np.any(pair != 0, axis=1)))
        harmonic = seen.get(begin, 0)
        seen[begin] = harmonic + 1
        if np.abs(pair[train]).max(initial=0.0) > 0:
            known.setdefault(harmonic, []).append(float(np.hypot(beta[k], beta[k + 1])))
        elif np.abs(pair[rows]).max(initial=0.0) > 0:
            fresh.append((k, harmonic))
    out = np.zeros(len(e))
    fresh = [(k, h) for k, h in fresh if h in known]
    if not fresh:
        return out
    at = [c for k, _ in fresh for c in (k, k + 1)]
    b = solve(pairs[rows][:, at], e)
    for j, (k, harmonic) in enumerate(fresh):
        here = b[2 * j : 2 * j + 2]
        size = float(np.median(known[harmonic])) / max(float(np.hypot(here[0], here[1])), 1e-300)
        out += pairs[rows, k : k + 2] @ here * size
    return out


def compare(
    problem: Problem,
    x0: Array,
    beta0: Array,
    x1: Array,
    beta1: Array,
    whitener: Whitener,
    phases: tuple[Sequence[slice], Sequence[slice]] = ((), ()),
) -> HeldOut:
    """Compare two fitted models on the held-out rows; `phases` as in `predict_residual`, of either model."""
    rows = problem.test
    if rows.sum() < 20:
        return HeldOut(float("nan"), float("nan"), 0.0, 0.0)
    e0 = predict_residual(problem, x0, beta0, rows, phases[0])
    e1 = predict_residual(problem, x1, beta1, rows, phases[1])
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
FOLD_S = 6.0  # s per piece at most: pieces of one fold are spread over all runs
PER_FOLD = 2  # pieces of a fold at least: a short log is cut finer, never left in one piece
LEAST_PIECE = 8  # rows


def folds(problem: Problem, use: Mask) -> NDArray[np.int64]:
    """Fold of every row in `use`: pieces of each run dealt out in turn, every run's from the next fold on:
    what happens at the beginning of every run must not lie in one fold.

    A piece lasts FOLD_S, or less where that would leave a fold with fewer than PER_FOLD pieces.
    """
    run, t = problem.run[use], problem.t[use]
    begin = {k: float(t[run == k].min()) for k in np.unique(run)}
    since = t - np.array([begin[k] for k in run.tolist()])
    total = sum(float(since[run == k].max()) + problem.period_s for k in begin)
    piece_s = max(min(FOLD_S, total / (FOLDS * PER_FOLD)), LEAST_PIECE * problem.period_s)
    piece = np.floor(since / piece_s + 1e-9).astype(np.int64)
    order = np.unique(run, return_inverse=True)[1].reshape(-1)
    rank = np.unique(np.column_stack([order, piece]), axis=0, return_inverse=True)[1].reshape(-1)
    first = np.array([rank[order == k].min() for k in range(len(begin))])
    return np.asarray((rank - first[order] + order) % FOLDS, dtype=np.int64)


def cross_validate(problem: Problem, x0: Array, x1: Array, whitener: Whitener) -> HeldOut:
    """Score two designs on training rows they were not fitted to, in FOLDS folds of pieces in time.

    Rows that the other folds' fit tells less of than they do themselves (leverage above one: a place that no
    other fold has been to) test nothing and are left out. Not a number where what is left makes fewer than
    two folds.
    """
    rows = problem.train
    use = whitener.usable(rows)
    nothing = HeldOut(float("nan"), float("nan"), 0.0, 0.0)
    if use.sum() < 100:
        return nothing
    fold = folds(problem, use)
    dealt = np.unique(fold)
    if len(dealt) < 2:
        return nothing
    y = whitener.apply(np.where(rows, problem.y, 0.0))[use]
    left: list[Array] = []
    told = np.ones(len(y), dtype=bool)
    for x in (x0, x1):
        w = whitener.apply(np.where(rows[:, None], x, 0.0))[use]
        e = np.empty(len(y))
        for k in dealt:
            out = fold == k
            e[out] = y[out] - w[out] @ solve(w[~out], y[~out])
            if x is x1:
                told[out] = leverage(w[~out], w[out]) <= 1.0
        left.append(e)
    if told.sum() < 100 or len(np.unique(fold[told])) < 2:
        return nothing
    e0, e1, fold = left[0][told], left[1][told], fold[told]
    dealt = np.unique(fold)
    b, a = float(np.sqrt(np.mean(e0**2))), float(np.sqrt(np.mean(e1**2)))
    gains = [float(np.sum((e0**2 - e1**2)[fold == k])) for k in dealt]
    return HeldOut(
        b, a, paired_z(e0**2 - e1**2, problem.block), 1 - (a / b) ** 2 if b > 0 else 0.0, min(gains) > 0
    )
