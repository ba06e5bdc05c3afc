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


def share(hits: int, runs: int) -> tuple[float, float, float]:
    """Share of hits and its 95 % interval by Wilson; (nan, 0, 1) without runs."""
    if not runs:
        return float("nan"), 0.0, 1.0
    from scipy.stats import binomtest

    found = binomtest(hits, runs).proportion_ci(LEVEL, method="wilson")
    return hits / runs, float(found.low), float(found.high)
