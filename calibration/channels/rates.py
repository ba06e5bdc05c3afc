"""Rates from positions: local polynomials, applied alike to everything they are compared with."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.readers.run import Array


def local_polynomial(x: Array, window: int, derivative: int, period: float) -> Array:
    """Savitzky-Golay smoothing (cubic) or derivative with an odd window; short series use what there is."""
    from scipy.signal import savgol_filter

    window = min(window | 1, (len(x) - 1) | 1)
    if window < 5:
        return x if derivative == 0 else np.gradient(x, period) if derivative == 1 else np.zeros_like(x)
    return np.asarray(savgol_filter(x, window, 3, deriv=derivative, delta=period))


def regular(
    t: Array, columns: dict[str, Array], period: float, run: NDArray[np.int64] | None = None
) -> tuple[Array, dict[str, Array]]:
    """Linear interpolation of unevenly sampled columns onto a regular grid (NaN samples are skipped)."""
    grid = t[0] + period * np.arange(int(np.floor((t[-1] - t[0]) / period)) + 1)
    out = {}
    for name, x in columns.items():
        good = np.isfinite(x)
        out[name] = np.interp(grid, t[good], x[good]) if good.any() else np.full(len(grid), np.nan)
    return grid, out
