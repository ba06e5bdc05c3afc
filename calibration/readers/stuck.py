"""Columns that hold one number while the axis moves under them: such a column measures nothing."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from calibration.errors import CalibrationInputError
from calibration.readers.run import Array

# counts that a column must have missed before it is stuck and not merely coarse: one count of rounding at
# either end of its range, and one of noise
MISSED = 3.0
FEWEST = 100  # rows that say how far the axis moved
WIDTH = 25  # rows (one packet, log-format.md) over which the position's own noise is averaged out of its rate


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
    rate = (x[WIDTH:] - x[:-WIDTH])[span > 0] / span[span > 0]
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
