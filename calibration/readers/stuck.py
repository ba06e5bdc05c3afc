"""Columns that hold one number while the axis moves under them: such a column measures nothing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calibration.errors import CalibrationInputError
from calibration.readers.run import Array

# counts that a column must have missed before it is stuck and not merely coarse: one count of rounding at
# either end of its range, and one of noise
MISSED = 3.0
FEWEST = 100  # rows that say how far the axis moved
QUICKER = 10.0  # than the rows beside it: no axis speeds up so in 10 ms
FAR = 1e-4  # rad, 20 arcsec: more than noise at rest, an eighth of the shortest counter (2^16 counts)
WIDTH = 25  # rows (one packet, log-format.md) over which the position's own noise is averaged out of its rate


def _leaps(x: Array) -> NDArray[np.bool_]:
    """Whether each stretch of WIDTH rows holds a step that no motion makes: a counter that wraps early."""
    step = np.abs(np.diff(x))
    beside = np.maximum(np.append(step[1:], 0.0), np.insert(step[:-1], 0, 0.0))
    before = np.concatenate([[0], np.cumsum(step > QUICKER * beside + FAR)])
    return np.asarray(before[WIDTH:] > before[:-WIDTH])


def check_stuck(
    path: Path,
    raw: dict[str, Array],
    t: Array,
    position: Array,
    factors: dict[str, float],
    ratio: float,
    first: int,
) -> None:
    """Raise CalibrationInputError for a rate or an encoder that never changes although the position says that
    it must have done so by more than MISSED counts.

    `raw` are counts (n,), `t` s, `position` rad (n,), `factors` SI units per count, `ratio` motor turns per
    axis turn, `first` the line of the first row.
    """
    good = np.isfinite(position)
    if good.sum() < FEWEST:
        return
    t, x = t[good], position[good]
    span = t[WIDTH:] - t[:-WIDTH]
    whole = (span > 0) & ~_leaps(x)
    rate = (x[WIDTH:] - x[:-WIDTH])[whole] / span[whole]
    for name, motion in (
        ("velocity", rate),
        ("tach_a", rate * ratio),
        ("tach_b", rate * ratio),
        ("aux", x),
    ):
        values = raw.get(name)
        if values is None or not np.isfinite(values).any():
            continue
        held = values[np.isfinite(values)]
        if np.ptp(held) > 0 or len(motion) < FEWEST:
            continue
        moved = float(np.ptp(np.quantile(motion, [0.01, 0.99])))
        if moved > MISSED * factors[name]:
            raise CalibrationInputError(
                path,
                f"holds {held[0]:g} in every row while the position moves: it measures nothing, leave it out",
                first,
                name,
            )
