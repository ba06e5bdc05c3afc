"""Stamps that jump while the position goes on by one row: the clock's fault, no row is lost."""

import numpy as np
from numpy.typing import NDArray

from calibration.arrays import Array, Mask
from calibration.inputs.thresholds import BESIDE_A_GAP


def jumps_of_clock(x: Array, steps: NDArray[np.int64]) -> Mask:
    """Which of the steps (n - 1,), in periods, between rows at positions x (n,) are the clock's alone: the
    position went on by one row's motion, and not by theirs.

    The motion is that of BESIDE_A_GAP rows on either side, which go one way; at rest nothing tells.
    """
    travel = np.diff(x)
    out = np.zeros(len(steps), dtype=bool)
    for at in map(int, np.flatnonzero(steps > 1)):
        first = max(at - BESIDE_A_GAP, 0)
        near = np.delete((travel / steps)[first : at + 1 + BESIDE_A_GAP], at - first)
        near = near[np.isfinite(near)]
        if len(near) > BESIDE_A_GAP and abs(np.sign(near).sum()) == len(near):
            usual = float(np.median(near))
            out[at] = abs(travel[at] - usual) < abs(travel[at] - usual * steps[at])
    return out
