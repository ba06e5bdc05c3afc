"""Which input moves which metric: Spearman's rank correlation, bootstrap intervals; Wilson's for shares.

A hundred thousand runs must fit, too: nothing here makes an array of resamples times runs.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.stats import binomtest, rankdata

Array = npt.NDArray[np.float64]
RESAMPLES = 1000
LEVEL = 0.95
_ENDS = [(1.0 - LEVEL) / 2.0, (1.0 + LEVEL) / 2.0]
_NORMAL = 1.959964
"""Quantile of the normal distribution at the upper end."""
_FEWEST = 8
"""Fewer runs than this say nothing about a rank correlation."""
_MANY = 5000
"""With more runs the interval is Bonett and Wright's (2000, Psychometrika 65, 23): resampling a hundred
thousand takes half a minute a pair."""
_BLOCK = 1 << 20
"""Elements of an array of resamples, 8 MiB each."""


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
    good = np.isfinite(x) & np.isfinite(y)
    x, y = x[good], y[good]
    if len(x) < _FEWEST or np.ptp(x) == 0.0 or np.ptp(y) == 0.0:
        return None
    value = float(_correlation(rankdata(x[None], axis=1), rankdata(y[None], axis=1))[0])
    if len(x) > _MANY:
        return Influence(name, metric, value, *asymptotic(value, len(x)), len(x))
    found = np.concatenate(
        [
            _correlation(rankdata(x[picked], axis=1), rankdata(y[picked], axis=1))
            for picked in _resamples(len(x), seed)
        ]
    )
    low, high = np.nanquantile(found, _ENDS)
    return Influence(name, metric, value, float(low), float(high), len(x))


def asymptotic(value: float, runs: int) -> tuple[float, float]:
    """95 % interval of a rank correlation of many runs: Fisher's z, variance (1 + r^2 / 2) / (n - 3)."""
    z, half = np.arctanh(value), _NORMAL * np.sqrt((1.0 + 0.5 * value * value) / (runs - 3))
    return float(np.tanh(z - half)), float(np.tanh(z + half))


def _resamples(runs: int, seed: int) -> Iterator[npt.NDArray[np.int64]]:
    """RESAMPLES draws of `runs` out of as many, some rows at a time; the same however many come at a time."""
    random = np.random.default_rng(seed)
    most = max(1, _BLOCK // runs)
    for first in range(0, RESAMPLES, most):
        yield random.integers(runs, size=(min(most, RESAMPLES - first), runs))


def _correlation(a: Array, b: Array) -> Array:
    a = a - a.mean(axis=1, keepdims=True)
    b = b - b.mean(axis=1, keepdims=True)
    with np.errstate(invalid="ignore", divide="ignore"):
        found: Array = (a * b).sum(axis=1) / np.sqrt((a * a).sum(axis=1) * (b * b).sum(axis=1))
    return found


def share(hits: int, runs: int) -> tuple[float, float, float]:
    """Share of hits and its 95 % interval by Wilson (1927, JASA 22, 209); (nan, 0, 1) without runs."""
    if not runs:
        return float("nan"), 0.0, 1.0
    wilson = binomtest(hits, runs).proportion_ci(LEVEL, method="wilson")
    return hits / runs, float(wilson.low), float(wilson.high)
