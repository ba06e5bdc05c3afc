"""Tails of distributions far out, in log10, from special functions (scipy.stats is slow to import)."""

from __future__ import annotations

import numpy as np
from scipy.special import gammaincc, gammaln, stdtrit

from calibration.readers.run import Array


def chi2_log10(gain: Array | float, dof: Array | float) -> Array:
    """-log10 of the upper chi2 tail; the leading asymptotic term where the tail underflows."""
    x, a = np.maximum(np.asarray(gain, dtype=float), 0.0) / 2, np.asarray(dof, dtype=float) / 2
    x, a = np.broadcast_arrays(x, a)
    tail = gammaincc(a, x)
    far = tail < 1e-250
    safe = np.where(far, np.maximum(x, 1.0), 1.0)
    asymptotic = (a - 1) * np.log(safe) - safe - gammaln(a)
    return np.asarray(-np.where(far, asymptotic, np.log(np.where(far, 1.0, tail))) / np.log(10.0))


def variance_log10(ratio: float, count: float) -> float:
    """-log10 p (Chernoff's bound) that `count` independent normal values have `ratio` times the variance."""
    return float(count / 2 * (ratio - 1 - np.log(ratio)) / np.log(10.0)) if ratio > 1 else 0.0


def share_log10(hits: float, total: float, chance: float) -> float:
    """-log10 p (Chernoff's bound) of at least `hits` of `total` when each has the probability `chance`."""
    share = hits / max(total, 1.0)
    if share <= chance:
        return 0.0
    rest = (1 - share) * np.log((1 - share) / (1 - chance)) if share < 1 else 0.0
    return float(total * (share * np.log(share / chance) + rest) / np.log(10.0))


def rms_interval(e: Array, block: int) -> tuple[float, float, float]:
    """rms of e (n,) with a 95 % interval from the scatter of its blocks' mean squares."""
    edges = np.arange(0, len(e), block)
    squares = np.add.reduceat(e**2, edges) / np.diff([*edges, len(e)])
    size = float(np.sqrt(np.mean(e**2)))
    count = len(squares)
    error = float(np.std(squares, ddof=1)) / np.sqrt(count) / max(2 * size, 1e-300) if count > 1 else size
    reach = student_reach(max(count - 1, 1)) * error
    return size, max(size - reach, 0.0), size + reach


def median_reach(x: Array) -> float:
    """95 % half-width of the median of x (n,), n of at least 2, from its scatter (a normal median's error is
    1.25 times the mean's)."""
    return student_reach(len(x) - 1) * 1.25 * float(np.std(x, ddof=1)) / float(np.sqrt(len(x)))


def student_reach(dof: float, level: float = 0.975) -> float:
    """Quantile of Student's t."""
    return float(stdtrit(dof, level))
