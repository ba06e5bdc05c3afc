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


def student_reach(dof: float, level: float = 0.975) -> float:
    """Quantile of Student's t."""
    return float(stdtrit(dof, level))
