"""The scatter of strokes that are made again: two strokes the same way over one travel, place by place."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from calibration.channels.view import View, pieces
from calibration.readers.run import Array

FEWEST_ROWS, FEWEST_PAIRS = 200, 4  # compared rows, and pairs of strokes, before their scatter is a floor
LONG = 0.3  # of the longest stroke: a shorter one is a wobble
ENDS = 0.03  # of the travel, by which the ends of a stroke that is made again may differ
LASTS = 0.05  # likewise of its time: friction that is quicker is other friction
INNER = 0.02  # of the travel at either end that is left out: the place says little where the motion turns


def stroke_scatter(view: View, e: Array) -> float | None:
    """rms of what one stroke has more than the last one the same way, over the root of two, in the unit of
    `e` (n_fitted,; NaN where a row says nothing); None where strokes are not made again.

    Strokes need not be periodic, as a lag in time needs them to be.
    """
    x, t = view.x[view.rows], view.clock[view.rows]
    way = np.sign(np.round(view.direction[view.rows]))
    label = np.cumsum((np.diff(way, prepend=way[0]) != 0) | (np.diff(view.file[view.rows], prepend=0) != 0))
    found = [(a, b) for a, b in pieces(label) if b - a > 10 and way[a] != 0]
    longest = max((abs(x[b - 1] - x[a]) for a, b in found), default=0.0)
    found = [(a, b) for a, b in found if abs(x[b - 1] - x[a]) > LONG * longest > 0]
    differences: list[Array] = []
    for sign in (-1.0, 1.0):
        for one, two in pairwise((a, b) for a, b in found if way[a] == sign):
            d = _difference(x, t, e, one, two)
            if d is not None:
                differences.append(d)
    rows = sum(len(d) for d in differences)
    if len(differences) < FEWEST_PAIRS or rows < FEWEST_ROWS:
        return None
    return float(np.sqrt(np.mean(np.concatenate(differences) ** 2) / 2))


def _difference(x: Array, t: Array, e: Array, one: tuple[int, int], two: tuple[int, int]) -> Array | None:
    """e of the second stroke less that of the first at the same places; None for another motion."""
    (a, b), (c, d) = one, two
    travel = abs(x[b - 1] - x[a])
    apart = max(abs(x[a] - x[c]), abs(x[b - 1] - x[d - 1]))
    lasted, last = t[b - 1] - t[a], t[d - 1] - t[c]
    if apart > ENDS * travel or abs(last - lasted) > LASTS * lasted:
        return None
    way = float(np.sign(x[b - 1] - x[a]))
    z = np.maximum.accumulate(way * x[a:b])  # noise goes back a little
    at = way * x[c:d]
    inside = (at > z[0] + INNER * travel) & (at < z[-1] - INNER * travel)
    out = e[c:d][inside] - np.interp(at[inside], z, e[a:b])
    return np.asarray(out[np.isfinite(out)])
