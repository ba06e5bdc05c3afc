"""Which input moves which metric: Spearman's rank correlation, bootstrap intervals; Wilson's for shares."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
RESAMPLES = 1000
LEVEL = 0.95
_FEWEST = 8
"""Fewer runs than this say nothing about a rank correlation."""


class Influence(NamedTuple):
    """Rank correlation of an input and a metric, its 95 % interval, and how many runs it is from."""

    input: str
    metric: str
    value: float
    low: float
    high: float
    runs: int


def influence(name: str, x: Array, metric: str, y: Array, seed: int = 1) -> Influence | None:
    """None where there are too few runs with both, or one of them never changes."""
    from scipy.stats import rankdata

    good = np.isfinite(x) & np.isfinite(y)
    x, y = x[good], y[good]
    if len(x) < _FEWEST or np.ptp(x) == 0.0 or np.ptp(y) == 0.0:
        return None
    random = np.random.default_rng(seed)
    picked = random.integers(len(x), size=(RESAMPLES, len(x)))
    found = _correlation(rankdata(x[picked], axis=1), rankdata(y[picked], axis=1))
    value = _correlation(rankdata(x)[None], rankdata(y)[None])[0]
    tail = (1.0 - LEVEL) / 2.0
    low, high = np.nanquantile(found, [tail, 1.0 - tail])
    return Influence(name, metric, float(value), float(low), float(high), len(x))


def _correlation(a: Array, b: Array) -> Array:
    a = a - a.mean(axis=1, keepdims=True)
    b = b - b.mean(axis=1, keepdims=True)
    with np.errstate(invalid="ignore", divide="ignore"):
        found: Array = (a * b).sum(axis=1) / np.sqrt((a * a).sum(axis=1) * (b * b).sum(axis=1))
    return found


class Indices(NamedTuple):
    """Sobol indices of a metric, one of each per input, with 95 % intervals (inputs, 2)."""

    metric: str
    first: Array
    first_interval: Array
    total: Array
    total_interval: Array


def sobol(metric: str, y: Array, inputs: int, seed: int = 1) -> Indices | None:
    """First-order and total indices from the runs of a `saltelli` sample in its order; None while a run is
    missing or has no such figure, or nothing changes it. By scipy.stats.sobol_indices."""
    from scipy.stats import sobol_indices

    n = len(y) // (inputs + 2)
    if n < 2 or n * (inputs + 2) != len(y) or not np.isfinite(y).all() or np.ptp(y) == 0.0:
        return None
    y = (y - y.mean()) / y.std()  # the estimators lose figures to a large mean
    blocks = y.reshape(inputs + 2, 1, n)
    given = {"f_A": blocks[0], "f_B": blocks[1], "f_AB": blocks[2:]}
    found = sobol_indices(func=given, n=n)
    spread = _resampled(blocks[0, 0], blocks[1, 0], blocks[2:, 0], seed)
    return Indices(metric, found.first_order.ravel(), spread[0], found.total_order.ravel(), spread[1])


def _resampled(one: Array, other: Array, mixed: Array, seed: int) -> tuple[Array, Array]:
    """Bootstrap intervals (inputs, 2) of both kinds of index, over the rows of the two samples; Saltelli's
    and Jansen's estimators, which scipy uses."""
    random = np.random.default_rng(seed)
    rows = random.integers(len(one), size=(RESAMPLES, len(one)))
    a, b, ab = one[rows], other[rows], mixed[:, rows]
    variance = np.var(np.concatenate([a, b], axis=1), axis=1)
    tail = (1.0 - LEVEL) / 2.0
    with np.errstate(invalid="ignore", divide="ignore"):
        first = np.mean(b * (ab - a), axis=2) / variance
        total = 0.5 * np.mean((a - ab) ** 2, axis=2) / variance
    ends = [tail, 1.0 - tail]
    return np.nanquantile(first, ends, axis=1).T, np.nanquantile(total, ends, axis=1).T


def share(hits: int, runs: int) -> tuple[float, float, float]:
    """Share of hits and its 95 % interval by Wilson; (nan, 0, 1) without runs."""
    if not runs:
        return float("nan"), 0.0, 1.0
    from scipy.stats import binomtest

    found = binomtest(hits, runs).proportion_ci(LEVEL, method="wilson")
    return hits / runs, float(found.low), float(found.high)
