"""Columns whose numbers cannot be in the format's unit: refused with line and column, not fitted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calibration.errors import CalibrationInputError
from calibration.readers.run import Array

OVER = 1.05  # of full scale: efforts are logged after their limit
LARGEST_COUNT = 2.0**40  # an unwrapped 29-bit counter would need two thousand turns
LEAST_EFFORT = 30.0  # counts: one per cent of the supply; less has never turned an axis
NEEDED = ("effort", "position")


def check_values(path: Path, raw: dict[str, Array], scales: dict[str, float], first: int) -> None:
    """Raise CalibrationInputError for infinities, empty needed columns and numbers of another unit."""
    for name, values in raw.items():
        _refuse(path, np.isinf(values), "is infinite", first, name)
    for name in NEEDED:
        if not np.isfinite(raw[name]).any():
            raise CalibrationInputError(path, "holds no number in any row", first, name)
    position, effort = raw["position"], raw["effort"]
    _refuse(path, np.abs(position) > LARGEST_COUNT, "is beyond any 29-bit counter", first, "position")
    full = scales["effort_full_scale"]
    _refuse(path, np.abs(effort) > OVER * full, f"is beyond full scale ({full:g})", first, "effort")
    if len(effort) < 100:
        return
    if _fractions(position) and np.nanmax(np.abs(position)) < 2e6:  # degrees or arcseconds of one turn
        raise CalibrationInputError(
            path, "holds fractions: it is logged in 29-bit counts, not in an angle", first, "position"
        )
    moved = float(np.nanmax(position) - np.nanmin(position))
    if _fractions(effort) and np.nanmax(np.abs(effort)) < LEAST_EFFORT and moved > 1000:
        raise CalibrationInputError(
            path,
            f"never exceeds {np.nanmax(np.abs(effort)):.3g}: it is logged in 1/{full:g} of the supply,"
            " not in V or as a fraction",
            first,
            "effort",
        )


def _fractions(values: Array) -> bool:
    good = values[np.isfinite(values)]
    return bool(np.mean(good != np.round(good)) > 0.5) if len(good) else False


def _refuse(path: Path, bad: NDArray[np.bool_], why: str, first: int, name: str) -> None:
    if bad.any():
        raise CalibrationInputError(path, why, first + int(np.argmax(bad)), name)
