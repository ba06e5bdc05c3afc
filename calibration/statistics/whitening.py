"""Autoregressive whitening of gappy series: coloured residuals make naive statistics lie (effects.md,
lesson 3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_toeplitz

from calibration.readers.run import Array

Mask = NDArray[np.bool_]


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
    size = 1 << (2 * len(x) - 1).bit_length()
    spectrum = np.abs(np.fft.rfft(x, size)) ** 2
    return np.asarray(np.fft.irfft(spectrum, size)[: lags + 1] / n)


# of the variance, as white noise: keeps the filter from living on bands where only the smoothing acts
LOADING = 0.3


def fit_ar(e: Array, valid: Mask, order: int) -> Whitener:
    """Yule-Walker fit of an AR(order) to the residual `e` (mean removed); order 0 gives the identity.

    The loading bounds how far any band can be lifted over another, so that a fit stays near least squares
    when the
    model is wrong in a band that carries little power.
    """
    if order == 0 or valid.sum() < 5 * order:
        return Whitener(np.zeros(0))
    x = e - float(np.mean(e[valid]))
    r = autocovariance(x, valid, order)
    r[0] *= 1 + LOADING
    if r[0] <= 0:
        return Whitener(np.zeros(0))
    return Whitener(np.asarray(solve_toeplitz(r[:order], r[1 : order + 1])))
