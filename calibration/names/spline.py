"""Smooth functions of any column as cubic B-splines."""

import numpy as np

from calibration.arrays import Array


def spline_columns(x: Array, knots: int) -> Array:
    """Cubic B-splines of x over its range, `knots` columns without the constant."""
    from scipy.interpolate import BSpline

    low, high = float(np.min(x)), float(np.max(x))
    if high <= low:
        return np.zeros((len(x), 0))
    inner = np.linspace(low, high, knots - 2)
    full = np.concatenate([[low] * 3, inner, [high] * 3])
    columns = BSpline.design_matrix(np.clip(x, low, high), full, 3).toarray()
    return np.asarray(columns[:, 1:])
