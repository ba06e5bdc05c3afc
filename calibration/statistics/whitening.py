"""Autoregressive whitening of gappy series: coloured residuals mislead (effects.md, lesson 3)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_toeplitz

from calibration.arrays import Array, Mask, by_median
from calibration.statistics.orders import power_of_two
from calibration.statistics.thresholds import LOADING, ROWS_PER_ORDER, SECOND

# rows, beyond the filter's own reach, over which a residual is compared with itself. ASSUMPTION: a swept line
# or a switch that sticks agrees with itself for longer than the filter lasts
LAGS = 50
APART = 4.0  # standard deviations of a Gaussian filter, after which it carries exp(-4), 2 %, over. arithmetic
# pairs of rows, to compare at all. ASSUMPTION: chance correlates 200 of white noise by a tenth of LEAST_SHARE
FEWEST = 200


@dataclass(frozen=True)
class Whitener:
    """x[k] - sum a_j x[k-j], with `a` of shape (p,); rows without p valid predecessors are dropped."""

    a: Array

    def apply(self, x: Array) -> Array:
        """Filter along axis 0."""
        if len(self.a) == 0:
            return x
        out = x.copy()
        for j, a in enumerate(self.a, 1):
            out[j:] -= a * x[:-j]
        return out

    def whiten(self, x: Array, valid: Mask) -> Array:
        """Column(s) (n,) or (n, k), filtered, of the usable rows of `valid`."""
        return self.apply(np.where(valid if x.ndim == 1 else valid[:, None], x, 0.0))[self.usable(valid)]

    def usable(self, valid: Mask) -> Mask:
        """Rows that have themselves and all predecessors valid."""
        out = valid.copy()
        for j in range(1, len(self.a) + 1):
            out[j:] &= valid[:-j]
            out[:j] = False
        return out


def autocovariance(e: Array, valid: Mask, lags: int) -> Array:
    """Autocovariance of a gappy series at lags 0..lags (products of valid pairs only, biased)."""
    x = np.where(valid, e, 0.0)
    n = max(int(valid.sum()), 1)
    size = power_of_two(2 * len(x))
    spectrum = np.abs(np.fft.rfft(x, size)) ** 2
    return np.asarray(np.fft.irfft(spectrum, size)[: lags + 1] / n)


def coherence(e: Array, rows: Mask, session: NDArray[np.int64], first: int) -> float:
    """Largest squared correlation of the residual `e` (n,) with itself, `first` rows later and more.

    rows: those that count, of one session each time; 0 where there are too few.
    """
    most = 0.0
    for lag in range(first, first + LAGS):
        both = rows[lag:] & rows[:-lag] & (session[lag:] == session[:-lag])
        if both.sum() < FEWEST:
            break
        most = max(most, float(np.corrcoef(e[lag:][both], e[:-lag][both])[0, 1]) ** 2)
    return most


def fit_ar(e: Array, valid: Mask, order: int) -> Whitener:
    """Yule-Walker fit of an AR(order) to the residual `e` (mean removed); order 0 gives the identity.

    The loading bounds how far a band can be lifted: a fit stays near least squares in weak bands.
    """
    if order == 0 or valid.sum() < ROWS_PER_ORDER * order:
        return Whitener(np.zeros(0))
    x = e - float(np.mean(e[valid]))
    r = autocovariance(x, valid, order)
    r[0] *= 1 + LOADING
    if r[0] <= 0:
        return Whitener(np.zeros(0))
    return Whitener(np.asarray(solve_toeplitz(r[:order], r[1 : order + 1])))


def white_noise(e: Array, valid: Mask, bursts: bool = True) -> float:
    """rms of sample-to-sample noise of `e` (n,), means over two boxcars; by medians without `bursts`."""
    second = np.diff(np.where(valid, e, np.nan), 2)
    size = np.sqrt(np.nanmean(second**2)) if bursts else by_median(second)
    return float(size / np.sqrt(SECOND))
