"""What the rig file says of a channel beyond its column's scale: a sign bit, a number per file, steps in
time, a rate that is integrated."""

from fnmatch import fnmatch
from pathlib import Path

import numpy as np

from calibration.arrays import Array
from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Column


def signed(path: Path, words: Array, bit: int, label: str) -> Array:
    """Sign-magnitude words (n,) as numbers: `bit`, from 0, is the sign."""
    if (words < 0).any():
        raise CalibrationInputError(path, "is signed already: leave sign_bit out", None, label)
    negative = np.floor(words / 2.0**bit) % 2 == 1
    return np.where(negative, -1.0, 1.0) * np.where(np.isfinite(words), words % 2.0**bit, np.nan)


def of_file(path: Path, where: Column, label: str) -> float:
    """The number of this file, by its name without the ending; 1 where no file has one."""
    if not where.files:
        return 1.0
    number = next((x for name, x in where.files.items() if fnmatch(path.stem, name)), None)
    if number is None:
        raise CalibrationInputError(path, f"'files' has no number for {path.stem}", None, label)
    return number


def over_time(where: Column, t: Array, values: Array) -> Array:
    """`values` (n,), rig units, times the steps declared, integrated where that is declared; t in s from the
    file's first row."""
    if where.steps:
        starts, sizes = np.array(where.steps).T
        values = values * np.where(t < starts[0], 0.0, sizes[np.searchsorted(starts[1:], t, side="right")])
    if where.integrated:
        good = np.isfinite(values)
        rate = np.interp(t, t[good], values[good])
        values = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(t))])
    return values
