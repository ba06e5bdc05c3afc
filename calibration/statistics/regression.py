"""Generalised least squares with autoregressive noise, and the covariance that coloured, uneven noise
needs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from calibration.readers.run import Array
from calibration.statistics.whitening import Mask, Whitener, fit_ar


@dataclass(frozen=True)
class Fit:
    """Coefficients (p,), their covariance (p, p), the residual (n,) in the channel's unit, and the noise
    model."""

    beta: Array
    covariance: Array
    residual: Array
    whitener: Whitener
    sigma: float  # rms of the whitened residual
    loglik: float
    rows: int


def solve(x: Array, y: Array) -> Array:
    """Least squares through scaled normal equations; columns without weight get a zero coefficient."""
    inv, scale = _inverse_gram(x)
    return np.asarray(inv @ ((x / scale).T @ y) / scale)


def leverage(x: Array, at: Array) -> Array:
    """(m,): variance of what a fit on rows x (n, p) predicts at rows `at` (m, p), of the noise's."""
    inv, scale = _inverse_gram(x)
    z = at / scale
    return np.asarray(np.einsum("ij,ij->i", z @ inv, z))


def _inverse_gram(x: Array) -> tuple[Array, Array]:
    scale = np.sqrt(np.einsum("ij,ij->j", x, x))
    scale[scale == 0] = 1.0
    gram = (x / scale).T @ (x / scale)
    w, v = np.linalg.eigh(gram)
    keep = w > 1e-11 * max(w.max(), 1e-300) if len(w) else w > 0
    return np.asarray((v[:, keep] / w[keep]) @ v[:, keep].T), scale


def gls(y: Array, x: Array, valid: Mask, order: int, block: int = 200, rounds: int = 2) -> Fit:
    """Fit y = x beta + AR(order) noise on the valid rows.

    The covariance is block-robust: scores summed over blocks of `block` rows, so that neither colour left
    by the
    short AR nor bursts of noise shrink the intervals.
    """
    yz, xz = np.where(valid, y, 0.0), np.where(valid[:, None], x, 0.0)
    beta = solve(xz[valid], yz[valid]) if x.shape[1] else np.zeros(0)
    whitener = Whitener(np.zeros(0))
    for _ in range(rounds):
        whitener = fit_ar(yz - xz @ beta, valid, order)
        use = whitener.usable(valid)
        yw, xw = whitener.apply(yz), whitener.apply(xz)
        if x.shape[1]:
            beta = solve(xw[use], yw[use])
    e = np.where(use, yw - xw @ beta, 0.0)
    n = max(int(use.sum()), 1)
    sigma = float(np.sqrt(np.sum(e**2) / n))
    cov = block_covariance(xw * use[:, None], e, block) if x.shape[1] else np.zeros((0, 0))
    loglik = -n * np.log(max(sigma, 1e-300))
    return Fit(beta, cov, y - x @ beta, whitener, sigma, float(loglik), n)


def under(y: Array, x: Array, valid: Mask, whitener: Whitener) -> float:
    """Log likelihood of y = x beta + noise on the valid rows with the noise's filter given, x refitted.

    Two models are compared through one filter: each one's own filter also takes out what the other explains.
    """
    use = whitener.usable(valid)
    yw = whitener.apply(np.where(valid, y, 0.0))[use]
    e = yw
    if x.shape[1]:
        xw = whitener.apply(np.where(valid[:, None], x, 0.0))[use]
        e = yw - xw @ solve(xw, yw)
    n = max(len(e), 1)
    return float(-n * np.log(max(float(np.sqrt(np.sum(e**2) / n)), 1e-300)))


def block_covariance(x: Array, e: Array, block: int) -> Array:
    """Sandwich covariance with scores summed over blocks of rows, small-sample corrected."""
    n, p = x.shape
    size = np.sqrt(np.einsum("ij,ij->j", x, x))
    size[size == 0] = 1.0
    x = x / size
    bread = np.linalg.pinv(x.T @ x, rcond=1e-11, hermitian=True)
    edges = np.arange(0, n, block)
    scores = np.add.reduceat(x * e[:, None], edges, axis=0)
    count = len(edges)
    meat = scores.T @ scores * (count / max(count - 1, 1))
    naive = bread * float(np.sum(e**2)) / max(n - p, 1)
    robust = bread @ meat @ bread
    # a sum over few blocks can come out too small by luck: never below the white-noise value
    lift = np.sqrt(np.maximum(np.diag(naive) / np.maximum(np.diag(robust), 1e-300), 1.0))
    return np.asarray(robust * np.outer(lift, lift) / np.outer(size, size))
