"""A residual of no domain that yet goes on from row to row: by elimination a function of time alone."""

import numpy as np
from numpy.typing import NDArray

from calibration.arrays import Array, Mask

# rows, beyond the filter's own reach, over which a residual is compared with itself. ASSUMPTION: a swept line
# or a switch that sticks agrees with itself for longer than the filter lasts
LAGS = 50
# standard deviations of a Gaussian filter, after which it carries exp(-4), 2 %, over. arithmetic
APART = 4.0
# pairs of rows, to compare at all. ASSUMPTION: chance correlates 200 of white noise by a tenth of LEAST_SHARE
FEWEST = 200


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
