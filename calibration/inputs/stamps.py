"""Time stamps that shake while the samples are taken on time: the position tells which of the two it was."""

from __future__ import annotations

import numpy as np

from calibration.inputs.record import Record, Repair
from calibration.readers.run import Array
from calibration.statistics.whitening import Mask

LEAST = 0.02  # of the sample period, rms about a line: less changes nothing. ASSUMPTION
BETTER = (
    0.5  # of the mean square that the position's neighbours leave by the stamps, that an even grid may leave
)
QUICK = 0.67  # of the rows by speed, beyond which a stamp's error shows in the position
FEWEST = 200  # such rows
GAP = 1.6  # sample periods between two rows: one is missing
ROUNDED = 1.5  # times what rounding to the stamps' own step leaves: no more is their resolution


def steady_stamps(record: Record) -> None:
    """Put the rows on an even grid where the position says that they were taken on one; in place."""
    t, x = record.columns["t"], record.columns["position"]
    if len(t) < FEWEST:
        return
    place = _places(t, record.period_s)
    grid = np.polyval(np.polyfit(place, t, 2), place)
    shake = float(np.std(t - grid))
    if shake < LEAST * record.period_s or shake > 0.5 * record.period_s:
        return  # a clock that wanders by whole samples is no jitter
    even, stamped, rows = _bends(place, x), _bends(t, x), _quick(place, x)
    if rows.sum() < FEWEST:
        return
    left, right = float(np.mean(even[rows] ** 2)), float(np.mean(stamped[rows] ** 2))
    if not left < BETTER * right:
        return
    record.columns["t"] = grid - grid[0]
    record.period_s = float(np.median(np.diff(grid)))
    rounding = shake < ROUNDED * _digits(t) / np.sqrt(12.0)
    kind, why = ("rounded", "their own step") if rounding else ("jitter", "the samples were taken evenly")
    note = f"time stamps shake by {1000 * shake:.3g} ms rms, {why}: rows are put on an even grid"
    record.repairs.append(Repair(kind, "time", len(t), shake, note))


def _places(t: Array, period_s: float) -> Array:
    """Sample number of every row: one on from the row before; more where rows are missing, which is where the
    rows on either side are far apart, too."""
    step = np.diff(t) / period_s
    pairs = step[1:] + step[:-1]
    apart = np.minimum(np.append(pairs, np.inf), np.insert(pairs, 0, np.inf))
    one = (step < GAP) | (apart < 1.0 + GAP)
    return np.concatenate([[0.0], np.cumsum(np.where(one, 1.0, np.maximum(np.rint(step), 1.0)))])


def _digits(t: Array) -> float:
    """The decimal step that all stamps are multiples of, s."""
    for step in 10.0 ** -np.arange(7.0):
        if np.allclose(t / step, np.rint(t / step), atol=1e-4, rtol=0.0):
            return float(step)
    return 0.0


def _bends(t: Array, x: Array) -> Array:
    """What the straight line between its neighbours leaves of every row (n,); NaN where there is none."""
    out = np.full(len(x), np.nan)
    part = (t[1:-1] - t[:-2]) / np.maximum(t[2:] - t[:-2], 1e-300)
    out[1:-1] = x[1:-1] - x[:-2] - (x[2:] - x[:-2]) * part
    return out


def _quick(place: Array, x: Array) -> Mask:
    """Rows between two neighbours, quicker than most: there the sensor's own steps matter least."""
    whole = np.zeros(len(x), dtype=bool)
    whole[1:-1] = (np.diff(place)[:-1] == 1) & (np.diff(place)[1:] == 1)
    speed = np.abs(np.gradient(x))
    whole &= np.isfinite(speed) & np.isfinite(_bends(place, x))
    return np.asarray(whole & (speed > np.quantile(speed[whole], QUICK))) if whole.any() else whole
