"""Does the motion repeat itself after some time, or stroke by stroke, and how do repeats differ?"""

from itertools import pairwise

import numpy as np

from calibration.arrays import Array
from calibration.balances import thresholds as limits
from calibration.balances.filters import pieces
from calibration.balances.view import View
from calibration.statistics.tails import rms
from calibration.statistics.whitening import autocovariance

ALIKE = 0.93  # of the autocorrelation of the position, at the lag of a repetition. ASSUMPTION
ROWS = 20_000  # that are correlated. ASSUMPTION
FEWEST_PAIRS = 4  # pairs of strokes, before their scatter is a floor: count. ASSUMPTION
LONG = 0.3  # of the longest stroke: a shorter one is a wobble. ASSUMPTION
ENDS = 0.03  # of the travel, by which the ends of a stroke that is made again may differ. ASSUMPTION
LASTS = 0.05  # likewise of its time: friction that is quicker is other friction. ASSUMPTION
# of the travel at either end that is left out: the place says little where the motion turns. ASSUMPTION
INNER = 0.02


def repeat_lag(view: View) -> int:
    """Full-rate rows after which the longest file's motion repeats itself; 0 when it does not."""
    files, count = np.unique(view.file, return_counts=True)
    wanted = view.columns.get("reference", view.x)  # repeats itself better than what is done
    x = wanted[view.file == files[int(np.argmax(count))]]
    step = max(len(x) // ROWS, 1)
    x = x[::step] - x.mean()
    n = len(x)
    if n < limits.FEWEST_MOVING or not np.any(x):
        return 0
    r = n * autocovariance(x, np.ones(n, dtype=bool), n - 1)
    power = np.concatenate([[0.0], np.cumsum(x**2)])
    lags = np.arange(n)
    both = np.sqrt(np.maximum((power[n - lags]) * (power[n] - power[lags]), 1e-300))
    r = r / both
    far = np.flatnonzero(r[: int(limits.LAG_PART * n)] < limits.OTHER_MOTION)
    if len(far) == 0:
        return 0
    first = int(far[0])
    at = first + int(np.argmax(r[first : int(limits.LAG_PART * n)]))
    best = float(r[at])
    early = [k for k in range(first + 1, at) if r[k] > best - 0.01 and r[k] >= r[k - 1] and r[k] >= r[k + 1]]
    at = early[0] if early else at
    return at * step if best > ALIKE else 0


def stroke_scatter(view: View, e: Array) -> float | None:
    """rms that strokes the same way differ by in `e` (n_fitted, or NaN), over root two; None of too few.

    Strokes need not be periodic, as a lag in time needs them to be.
    """
    x, t = view.x[view.rows], view.clock[view.rows]
    way = np.sign(np.round(view.direction[view.rows]))
    label = np.cumsum((np.diff(way, prepend=way[0]) != 0) | (np.diff(view.file[view.rows], prepend=0) != 0))
    found = [(a, b) for a, b in pieces(label) if b - a > limits.FEWEST_FOR_A_LEVEL and way[a] != 0]
    longest = max((abs(x[b - 1] - x[a]) for a, b in found), default=0.0)
    found = [(a, b) for a, b in found if abs(x[b - 1] - x[a]) > LONG * longest > 0]
    pairs = [k for sign in (-1.0, 1.0) for k in pairwise((a, b) for a, b in found if way[a] == sign)]
    differences = [d for one, two in pairs if (d := _difference(x, t, e, one, two)) is not None]
    if len(differences) < FEWEST_PAIRS or sum(map(len, differences)) < limits.FEWEST_ROWS:
        return None
    return rms(np.concatenate(differences)) / float(np.sqrt(2))


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
