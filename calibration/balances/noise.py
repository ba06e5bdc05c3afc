"""White noise of a column, from its differences from row to row, which the motion is too smooth to make.

It never comes from the residual of a fit, and is at least what rounding to whole counts leaves.
"""

from math import comb

import numpy as np
from numpy.typing import NDArray

from calibration.arrays import Array, Mask, by_median
from calibration.balances.frame import Frame
from calibration.balances.thresholds import FEWEST_FOR_A_SCATTER
from calibration.inputs.run import quantum
from calibration.statistics.regression import solve
from calibration.statistics.tails import rms
from plant.units import ARCSEC

ROUNDING = 1.0 / np.sqrt(12.0)  # rms of a rounding error, of a quantum
BLOCK = 100  # rows: the median over blocks of a second leaves out transients and lost packets. ASSUMPTION
# rows over which a loop answers a step of its sensor: a rate's two, and until it is sent. ASSUMPTION
LOOP_ROWS = 5
LEAST_BLOCKS = 3  # blocks, before their median is told. ASSUMPTION
# mean square of the smaller four fifths of normal values, of all: (0.8 - 2 q f(q)) / 0.8; arithmetic, a share
QUIET_PART = 0.4377
CONDUCTING = 2.0  # counts: a smaller current is cut off at zero. ASSUMPTION


def rough(x: Array, order: int, beside: Array | None = None) -> float:
    """rms of white noise in x (n,) from its `order`-th differences, by blocks; NaN when too short.

    beside (n,): what x follows through a loop, with the last rows' differences of which the noise is no part.
    """
    d = np.diff(x, order)
    if beside is not None and len(d) > BLOCK:
        steps = np.diff(beside, order)
        own = np.column_stack([np.pad(steps, (k, 0))[: len(d)] for k in range(LOOP_ROWS)])
        known = np.isfinite(d) & np.isfinite(own).all(axis=1)
        d = d - own @ solve(own[known], d[known])
    squares = [b**2 for b in np.split(d, range(BLOCK, len(d), BLOCK)) if np.isfinite(b).all()]
    blocks = [float(np.mean(b)) for b in squares]
    gain = comb(2 * order, order)  # sum of the squared binomials
    return float(np.sqrt(np.median(blocks) / gain)) if len(blocks) >= LEAST_BLOCKS else float("nan")


def row_to_row(x: Array, rows: Mask) -> float:
    """rms of white noise in x (n,) on `rows`, from its fourth differences; NaN of too few."""
    fourth = np.diff(np.where(rows, x, np.nan), 4)
    fourth = fourth[np.isfinite(fourth)]
    return rms(fourth) / float(np.sqrt(comb(8, 4))) if len(fourth) > FEWEST_FOR_A_SCATTER else float("nan")


def position_noise(x: Array, file: NDArray[np.int64], step: float | None = None) -> float:
    """rms of the position's white noise, from its fourth differences, and of its rounding.

    step: of the sensor, where x was put between its rows and has a smaller one itself.
    """
    fourth = np.diff(x, 4)[np.convolve(np.diff(file) != 0, np.ones(4), "valid")[: len(x) - 4] == 0]
    noise = by_median(fourth) / np.sqrt(comb(8, 4))
    own = quantum(x)
    if own is None:
        steps = np.abs(np.diff(x))
        steps = steps[steps > 1e-9 * (float(np.ptp(x)) or 1.0)]  # rows between two samples round differently
        own = float(np.quantile(steps, 0.02)) if len(steps) else 0.0
    return float(max(noise, max(own, step or 0.0) * ROUNDING))


def column_noise(frame: Frame) -> dict[str, float]:
    """rms per row of the columns that an axis' log has, in SI units, from the column alone (currents: beside
    the logged effort). Of the effort, what changes from row to row, of the full one."""
    scale, columns = frame.scale, frame.columns
    place, count = (scale[f"{k}_arcsec_per_count"] * ARCSEC for k in ("position", "velocity"))
    ampere = scale["adc_A_per_count"]
    found = {
        "position": (rough(columns["position"], 4), place),
        "velocity": (rough(columns["velocity"], 2), count / scale["velocity_window_s"]),
        "current_a": (_current_noise(frame, "current_a"), ampere),
        "current_b": (_current_noise(frame, "current_b"), ampere),
        "effort": (rough(columns["effort"], 2), 0.0),
    }
    # a column that is too short to tell is as good as its counts
    return {k: float(np.fmax(x, n * ROUNDING)) for k, (x, n) in found.items() if frame.get(k) is not None}


def _current_noise(frame: Frame, name: str) -> float:
    """A current's second differences beside the effort's, whose rounding moves the current for real."""
    i, effort = frame.columns[name], frame.columns["effort"]
    d, u = np.full(len(i), np.nan), np.full(len(i), np.nan)
    d[2:], u[2:] = np.diff(i, 2), np.diff(np.abs(effort), 2)
    x = np.column_stack([np.roll(u, k) for k in range(3)])
    ok = np.isfinite(d) & np.isfinite(x).all(axis=1) & (i > CONDUCTING * frame.scale["adc_A_per_count"])
    ok[:4] = False
    for side in (effort > 0, effort <= 0):  # a motor's share of the effort hangs on its sign
        rows = ok & side
        if rows.sum() > BLOCK:
            d[rows] -= x[rows] @ solve(x[rows], d[rows])
    parts = [b[np.isfinite(b)] for b in np.split(np.where(ok, d, np.nan), range(BLOCK, len(d), BLOCK))]
    # normal values by their smaller four fifths: what disturbs some rows does not count
    quiet = [np.sort(b**2)[: round(0.8 * len(b))] for b in parts if len(b) > BLOCK // 2]
    squares = [float(np.mean(b)) / QUIET_PART for b in quiet]
    return float(np.sqrt(np.median(squares) / 6.0)) if len(squares) >= LEAST_BLOCKS else float("nan")
