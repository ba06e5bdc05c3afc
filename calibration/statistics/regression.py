"""Generalised least squares with autoregressive noise, and a covariance for coloured, uneven noise."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.arrays import Array, Mask
from calibration.statistics.thresholds import SINGULAR
from calibration.statistics.whitening import Whitener, fit_ar


@dataclass(frozen=True)
class Fit:
    """Coefficients (p,), their covariance (p, p), residual (n,) in the channel's unit, noise model."""

    beta: Array
    covariance: Array
    residual: Array
    whitener: Whitener
    sigma: float  # rms of the whitened residual
    loglik: float
    rows: int

    @property
    def errors(self) -> Array:
        """Standard errors (p,) of the coefficients."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))


def solve(x: Array, y: Array) -> Array:
    """Least squares through scaled normal equations; columns without weight get a zero coefficient."""
    z, scale = _scaled(x)
    return np.asarray(_inverse(z.T @ z) @ (z.T @ y) / scale)


def solve_without(x: Array, y: Array, label: NDArray[np.int64]) -> list[Array]:
    """`solve` on all rows but those of one label, for every label in turn."""
    z, scale = _scaled(x)
    parts = [(z[m].T @ z[m], z[m].T @ y[m]) for m in (label == k for k in np.unique(label))]
    gram, along = sum(g for g, _ in parts), sum(a for _, a in parts)
    return [np.asarray(_inverse(gram - g) @ (along - a) / scale) for g, a in parts]


def told(x: Array, at: Array) -> NDArray[np.bool_]:
    """(m,): whether a fit on rows x (n, p) tells rows `at` (m, p): in its span, no noisier than noise."""
    z, scale = _scaled(x)
    w, v = np.linalg.eigh(z.T @ z)
    there = at / scale
    outside = there @ v[:, w <= SINGULAR * max(w.max(initial=0.0), 1e-300)]
    within = np.sum(outside**2, axis=1) <= np.sqrt(SINGULAR) * np.sum(there**2, axis=1)
    return np.asarray(within & (leverage(x, at) <= 1.0))


def leverage(x: Array, at: Array) -> Array:
    """(m,): variance of what a fit on rows x (n, p) predicts at rows `at` (m, p), of the noise's."""
    z, scale = _scaled(x)
    return np.asarray(np.einsum("ij,ij->i", at / scale @ _inverse(z.T @ z), at / scale))


def inflation(x: Array) -> Array:
    """(p,): variance of every coefficient of columns x (n, p) by the others; huge for twins and for zeros."""
    z, _ = _scaled(x)
    return np.asarray(np.diag(np.linalg.inv(z.T @ z + SINGULAR * np.eye(x.shape[1]))))


def _scaled(x: Array) -> tuple[Array, Array]:
    """Columns of norm 1, and what they were divided by: 1 for a column of zeros."""
    scale = np.sqrt(np.einsum("ij,ij->j", x, x))
    scale[scale == 0] = 1.0
    return x / scale, scale


def _inverse(gram: Array) -> Array:
    w, v = np.linalg.eigh(gram)
    keep = w > SINGULAR * max(w.max(initial=0.0), 1e-300)
    return np.asarray((v[:, keep] / w[keep]) @ v[:, keep].T)


def gls(y: Array, x: Array, valid: Mask, order: int, block: int = 200, rounds: int = 2) -> Fit:
    """Fit y = x beta + AR(order) noise on the valid rows.

    The covariance is block-robust, by scores of `block` rows: colour left and bursts do not shrink it.
    """
    yz, xz = np.where(valid, y, 0.0), np.where(valid[:, None], x, 0.0)
    beta = solve(xz[valid], yz[valid])
    whitener = Whitener(np.zeros(0))
    yw, xw, use = yz, xz, valid
    for _ in range(rounds if order else 0):
        whitener = fit_ar(yz - xz @ beta, valid, order)
        use = whitener.usable(valid)
        yw, xw = whitener.apply(yz), whitener.apply(xz)
        beta = solve(xw[use], yw[use])
    e = np.where(use, yw - xw @ beta, 0.0)
    n = max(int(use.sum()), 1)
    sigma = float(np.sqrt(np.sum(e**2) / n))
    cov = block_covariance(xw * use[:, None], e, block)
    return Fit(beta, cov, y - x @ beta, whitener, sigma, _loglik(e, n), n)


def under(y: Array, x: Array, valid: Mask, whitener: Whitener) -> float:
    """Log likelihood of y = x beta + noise on the valid rows with the noise's filter given, x refitted.

    Two models are compared through one filter: each one's own filter also takes out what the other explains.
    """
    e, w = whitener.whiten(y, valid), whitener.whiten(x, valid)
    return _loglik(e - w @ solve(w, e), max(len(e), 1))


def _loglik(e: Array, rows: int) -> float:
    """Log likelihood of white noise of the size of e."""
    return float(-rows * np.log(max(float(np.sqrt(np.sum(e**2) / rows)), 1e-300)))


def block_covariance(x: Array, e: Array, block: int) -> Array:
    """Sandwich covariance with scores summed over blocks of rows, small-sample corrected."""
    n, p = x.shape
    x, size = _scaled(x)
    bread = np.linalg.pinv(x.T @ x, rcond=SINGULAR, hermitian=True)
    edges = np.arange(0, n, block)
    scores = np.add.reduceat(x * e[:, None], edges, axis=0)
    count = len(edges)
    meat = scores.T @ scores * (count / max(count - 1, 1))
    naive = bread * float(np.sum(e**2)) / max(n - p, 1)
    robust = bread @ meat @ bread
    # a sum over few blocks can come out too small by luck: never below the white-noise value
    lift = np.sqrt(np.maximum(np.diag(naive) / np.maximum(np.diag(robust), 1e-300), 1.0))
    return np.asarray(robust * np.outer(lift, lift) / np.outer(size, size))
