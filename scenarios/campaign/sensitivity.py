"""Which input moves which metric: Spearman's rank correlation, bootstrap intervals; Wilson's for shares.

A hundred thousand runs must fit, too: nothing here makes an array of resamples times runs.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.stats import binomtest, rankdata, sobol_indices

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
            for picked in _resamples(len(x), len(x), seed)
        ]
    )
    low, high = np.nanquantile(found, _ENDS)
    return Influence(name, metric, value, float(low), float(high), len(x))


def asymptotic(value: float, runs: int) -> tuple[float, float]:
    """95 % interval of a rank correlation of many runs: Fisher's z, variance (1 + r^2 / 2) / (n - 3)."""
    z, half = np.arctanh(value), _NORMAL * np.sqrt((1.0 + 0.5 * value * value) / (runs - 3))
    return float(np.tanh(z - half)), float(np.tanh(z + half))


def _resamples(runs: int, width: int, seed: int) -> Iterator[npt.NDArray[np.int64]]:
    """RESAMPLES draws of `runs` out of as many, some rows at a time; width: elements a row comes to. The
    draws are the same however many come at a time."""
    random = np.random.default_rng(seed)
    most = max(1, _BLOCK // width)
    for first in range(0, RESAMPLES, most):
        yield random.integers(runs, size=(min(most, RESAMPLES - first), runs))


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
    """First-order and total indices from the runs of a `saltelli` sample in its order. None while a run is
    missing or has no such figure, or nothing changes it. By scipy.stats.sobol_indices."""
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
    firsts, totals = [], []
    for rows in _resamples(len(one), mixed.size, seed):
        a, b, ab = one[rows], other[rows], mixed[:, rows]
        variance = np.var(np.concatenate([a, b], axis=1), axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            firsts.append(np.mean(b * (ab - a), axis=2) / variance)
            totals.append(0.5 * np.mean((a - ab) ** 2, axis=2) / variance)
    found = [np.concatenate(each, axis=1) for each in (firsts, totals)]
    return np.nanquantile(found[0], _ENDS, axis=1).T, np.nanquantile(found[1], _ENDS, axis=1).T


def share(hits: int, runs: int) -> tuple[float, float, float]:
    """Share of hits and its 95 % interval by Wilson (1927, JASA 22, 209); (nan, 0, 1) without runs."""
    if not runs:
        return float("nan"), 0.0, 1.0
    wilson = binomtest(hits, runs).proportion_ci(LEVEL, method="wilson")
    return hits / runs, float(wilson.low), float(wilson.high)
