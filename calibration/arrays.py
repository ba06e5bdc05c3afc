"""Arrays as every floor of calibration hands them on."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

MEDIAN = 1.4826  # standard deviations, of a normal value's median size. By definition


def by_median(x: Array) -> float:
    """Standard deviation of normal values x (n,) about zero, by the median of their sizes; without NaN."""
    return MEDIAN * float(np.nanmedian(np.abs(x)))
