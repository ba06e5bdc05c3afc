"""Numbers of both signs that a logger wrote as unsigned words: 65535 is -1."""

import numpy as np

from calibration.arrays import Array
from calibration.inputs import thresholds as limits
from calibration.inputs.declaration import Rig
from calibration.inputs.repair import MOVING, WORDS
from calibration.inputs.run import Repair, Run


def read_signed(runs: list[Run], rig: Rig) -> None:
    """Read such columns with their sign, in place and in every run alike; `run.repairs` says so."""
    for channel, where in rig.columns.items():
        if channel in ("time", *MOVING) or where.wrap is not None:
            continue
        words = [(r.columns[channel] - where.offset) / where.scale for r in runs]
        length = word_length(np.concatenate(words))
        note = f"signed numbers of {length:g} values written unsigned: {length - 1:g} is -1"
        for r, x in zip(runs, words, strict=True):
            if count := int(np.count_nonzero(x > length / 2)) if length else 0:
                r.columns[channel] = np.where(x > length / 2, x - length, x) * where.scale + where.offset
                r.repairs.append(Repair("signed", channel, count, length * abs(where.scale), note))


def word_length(x: Array) -> float:
    """Values that the word of `x` (n,) has, 0 where it is no such word.

    Numbers of either sign fill the two ends of the word, and the middle quarter of it stays empty.
    """
    x = x[np.isfinite(x)]
    if len(x) < limits.FEWEST_SAMPLES or x.min() < 0 or not np.array_equal(x, np.round(x)):
        return 0.0
    length = next((w for w in WORDS if x.max() < w), 0.0)
    lower, upper = x < length * 3 / 8, x >= length * 5 / 8
    # one value at the end of a word is a reading that failed
    several = len(np.unique(x[upper])) >= limits.FEWEST_SIGNED
    return length if several and bool(np.all(lower | upper)) else 0.0
