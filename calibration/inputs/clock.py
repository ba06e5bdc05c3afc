"""The clock of a table: parts that start again, rows whose stamp leaps back, and what is refused."""

import itertools
from bisect import bisect_right
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calibration.arrays import Array
from calibration.errors import CalibrationInputError

FROM_THE_FIRST = 3.0  # steps of a clock from its first stamp, where it starts again. ASSUMPTION
# of the rows, that may stand out of order: more is another clock's, or another order of the rows. ASSUMPTION
STRAY = 0.01


def parts_of_clock(raw: dict[str, Array], t: Array) -> list[tuple[dict[str, Array], int]]:
    """A table by its clock `t` (n,), each part with the number of its rows that were left out.

    Stray rows are left out. Without any it has parts where the clock starts again from its first stamp.
    """
    kept = in_order(t)
    if len(kept) < len(t):
        return [({name: x[kept] for name, x in raw.items()}, len(t) - len(kept))]
    back = np.flatnonzero(np.diff(t) < 0) + 1
    if not len(back) or np.any(np.abs(t[back] - t[0]) > FROM_THE_FIRST * np.median(np.abs(np.diff(t)))):
        return [(raw, 0)]
    edges = itertools.pairwise([0, *back, len(t)])
    return [({name: x[a:b] for name, x in raw.items()}, 0) for a, b in edges]


def in_order(t: Array) -> NDArray[np.int64]:
    """Rows of the longest part of a clock `t` (n,) that never goes back; all, where many are stray."""
    every = np.arange(len(t))
    back = int(np.sum(np.diff(t) < 0))  # every one of them costs a row
    if not np.isfinite(t).all() or not 0 < back <= STRAY * len(t):
        return every
    ends, at, before = list[float](), list[int](), list[int]()
    for k, stamp in enumerate(t.tolist()):  # the least last stamp of a part of every length
        length = bisect_right(ends, stamp)
        before.append(at[length - 1] if length else -1)
        ends[length : length + 1], at[length : length + 1] = [stamp], [k]
    kept = [at[-1]]
    while before[kept[-1]] >= 0:
        kept.append(before[kept[-1]])
    return every if len(t) - len(kept) > STRAY * len(t) else np.array(kept[::-1])


def check_clock(path: Path, t: Array, name: str) -> None:
    """Refuse a clock (n,) of finite stamps that does not go forward."""
    if len(t) > 1 and not np.median(np.diff(t)) > 0:
        raise CalibrationInputError(path, "does not advance", None, name)
    for k in np.flatnonzero(np.diff(t) < 0)[:1]:
        raise CalibrationInputError(path, f"time goes backwards from {t[k]:g} to {t[k + 1]:g}", k + 2, name)
