"""Which input moves which metric: Spearman's rank correlation; Wilson's interval for shares."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.stats import binomtest, spearmanr

Array = npt.NDArray[np.float64]
LEVEL = 0.95
_NORMAL = 1.959964
"""Quantile of the normal distribution at the upper end."""
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


def influence(name: str, x: Array, metric: str, y: Array) -> Influence | None:
    """None where there are too few runs with both, or one of them never changes.

    The interval is Bonett and Wright's (2000, Psychometrika 65, 23): Fisher's z, variance
    (1 + r^2 / 2) / (n - 3).
    """
    good = np.isfinite(x) & np.isfinite(y)
    x, y = x[good], y[good]
    if len(x) < _FEWEST or np.ptp(x) == 0.0 or np.ptp(y) == 0.0:
        return None
    value = float(spearmanr(x, y).statistic)
    with np.errstate(divide="ignore"):  # of runs in the very same order
        z = np.arctanh(np.clip(value, -1.0, 1.0))
    half = _NORMAL * np.sqrt((1.0 + 0.5 * value * value) / (len(x) - 3))
    return Influence(name, metric, value, float(np.tanh(z - half)), float(np.tanh(z + half)), len(x))


def share(hits: int, runs: int) -> tuple[float, float, float]:
    """Share of hits and its 95 % interval by Wilson (1927, JASA 22, 209); (nan, 0, 1) without runs."""
    if not runs:
        return float("nan"), 0.0, 1.0
    wilson = binomtest(hits, runs).proportion_ci(LEVEL, method="wilson")
    return hits / runs, float(wilson.low), float(wilson.high)
