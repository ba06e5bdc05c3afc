"""On which flank the gapped coupling of an encoder lies, by the reading alone.

A reading behind a gap moves only while a flank drives it, so its last direction says which one. This holds
even where motors leave their teeth in open loop. While the reading stands, the axis may be anywhere in the
gap.
"""

import numpy as np
from numpy.typing import NDArray

from calibration.arrays import Array
from calibration.balances.context import direction_of
from calibration.balances.kinematic import APART_ARCSEC
from plant.units import ARCSEC

# of the reading's noise per row, rms: two rows differ by so much once in 1e8, so it has moved. arithmetic
MOVED = 8.0
# within which it must move so far on either side of a row: one row of the analysis grid. ASSUMPTION
WAIT_ROWS = 3


def driven_side(reading: Array, run: NDArray[np.int64], noise: float) -> Array:
    """1 where the coupling drives `reading` (n,) forwards, -1 backwards, NaN where it may be in its gap.

    `noise` is the reading's own per row, in its unit.
    """
    least = MOVED * noise
    side = direction_of(reading, run, least)
    step = np.abs(reading[WAIT_ROWS:] - reading[:-WAIT_ROWS])
    moved = (step > least) & (side[WAIT_ROWS:] == side[:-WAIT_ROWS]) & (run[WAIT_ROWS:] == run[:-WAIT_ROWS])
    before = np.concatenate([np.zeros(WAIT_ROWS, dtype=bool), moved])
    after = np.concatenate([moved, np.zeros(WAIT_ROWS, dtype=bool)])
    return np.where(before & after, side, np.nan)


def carried_on(seen: Array, place: Array, run: NDArray[np.int64]) -> Array:
    """`seen` (n,) rad, gaps filled along `place` from both ends; straight where a motor left its teeth."""
    out = seen.copy()
    for k in np.unique(run):
        rows = np.flatnonzero(run == k)
        known = rows[np.isfinite(seen[rows])]
        if len(known) == 0:
            out[rows] = place[rows]
            continue
        off = seen[known] - place[known]
        out[rows] = place[rows] + np.interp(rows, known, off)
        left = np.abs(np.diff(off)) > APART_ARCSEC * ARCSEC
        for a, b in zip(known[:-1][left], known[1:][left], strict=True):
            out[a : b + 1] = np.linspace(seen[a], seen[b], b - a + 1)
    return out
