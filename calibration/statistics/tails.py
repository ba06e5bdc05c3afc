"""Tails of distributions far out, in log10, from special functions (scipy.stats is slow to import)."""

import numpy as np
from scipy.special import betainc, betaln, rel_entr, stdtrit

from calibration.arrays import Array
from calibration.finding import Parameter, normal
from calibration.statistics.thresholds import SMALLEST_TAIL


def wald_log10(wald: Array | float, width: Array | float, blocks: float) -> Array:
    """-log10 p of a Wald statistic of `width` coefficients with covariance from independent `blocks`, so wald
    / width is F(width, blocks - 1). It is the leading term where the tail underflows."""
    x, b = np.broadcast_arrays(np.maximum(np.asarray(wald, dtype=float), 0.0), np.asarray(width) / 2)
    a = max(blocks - 1.0, 1.0) / 2
    part = 2 * a / (2 * a + x)
    tail = betainc(a, b, part)
    far = tail < SMALLEST_TAIL
    leading = a * np.log(part) - np.log(a) - betaln(a, b)
    return np.asarray(-np.where(far, leading, np.log(np.where(far, 1.0, tail))) / np.log(10.0))


def variance_log10(ratio: float, count: float) -> float:
    """-log10 p (Chernoff's bound) that `count` independent normal values have `ratio` times the variance."""
    return float(count / 2 * (ratio - 1 - np.log(ratio)) / np.log(10.0)) if ratio > 1 else 0.0


def share_log10(hits: float, total: float, chance: float) -> float:
    """-log10 p (Chernoff's bound) of at least `hits` of `total` when each has the probability `chance`."""
    share = hits / max(total, 1.0)
    distance = rel_entr(share, chance) + rel_entr(1 - share, 1 - chance)
    return float(total * distance / np.log(10.0)) if share > chance else 0.0


def rms(x: Array) -> float:
    """Of x (n,); not a number where there is none."""
    return float(np.sqrt(np.mean(x**2))) if len(x) else float("nan")


def rms_interval(e: Array, block: int) -> tuple[float, float, float]:
    """rms of e (n,) with a 95 % interval from the scatter of its blocks' mean squares."""
    edges = np.arange(0, len(e), block)
    squares = np.add.reduceat(e**2, edges) / np.diff([*edges, len(e)])
    size = rms(e)
    count = len(squares)
    error = float(np.std(squares, ddof=1)) / np.sqrt(count) / max(2 * size, 1e-300) if count > 1 else size
    reach = student_reach(max(count - 1, 1)) * error
    return size, max(size - reach, 0.0), size + reach


def median_reach(x: Array) -> float:
    """95 % half-width of the median of x (n,), n of at least 2: its error is 1.25 times the mean's."""
    return student_reach(len(x) - 1) * 1.25 * float(np.std(x, ddof=1)) / float(np.sqrt(len(x)))


def middle(x: Array, unit: str) -> Parameter:
    """The median of several measurements (n,) of one size; without an interval where there is only one."""
    value = float(np.median(x))
    return normal(value, 1.0, unit, median_reach(x)) if len(x) > 1 else Parameter(value, unit)


def student_reach(dof: float, level: float = 0.975) -> float:
    """Quantile of Student's t."""
    return float(stdtrit(dof, level))
