"""Coefficients that a few blocks of rows carry: how sure these make them, and how many they are.

A block that carries a coefficient alone bends it to itself. So its residual says too little there.
"""

from dataclasses import replace

import numpy as np

from calibration.arrays import Array, Mask
from calibration.statistics.regression import Fit, solve, solve_without
from calibration.statistics.thresholds import SINGULAR


def carried(fit: Fit, x: Array, valid: Mask, block: int) -> tuple[Fit, Array]:
    """The fit of x (n, p) with the jackknife's errors over blocks of `block` rows, no smaller than before.

    Also the blocks (p,) that carry each coefficient, counted by weight: (sum w)^2 / sum w^2. Sources: Bell
    and McCaffrey 2002; Carter, Schnepel and Steigerwald 2017.
    """
    rows, e = fit.whitener.whiten(x, valid), fit.whitener.whiten(fit.residual, valid)
    label = np.arange(len(rows)) // block
    count = int(label[-1]) + 1 if len(label) else 0
    if count < 2:
        return fit, np.full(x.shape[1], float(count))
    moves = np.array(solve_without(rows, e, label)) - solve(rows, e)
    errors = np.sqrt((count - 1) / count * np.sum(moves**2, axis=0))
    lift = np.maximum(errors / np.maximum(fit.errors, 1e-300), 1.0)
    size = np.linalg.norm(rows, axis=0)
    pull = np.linalg.pinv(rows / np.where(size > 0, size, 1.0), rcond=SINGULAR).T  # of a row on a coefficient
    weights = np.add.reduceat(pull**2, np.arange(0, len(rows), block))
    blocks = weights.sum(axis=0) ** 2 / np.maximum(np.sum(weights**2, axis=0), 1e-300)
    return replace(fit, covariance=fit.covariance * np.outer(lift, lift)), blocks
