"""The clock of a table: parts that start again or have a label of their own, rows whose stamp leaps back, and
what is refused."""

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
LONG_GAP = 100.0  # rows, longer than a filter reaches. ASSUMPTION


def parts_of_clock(raw: dict[str, Array], t: Array) -> list[tuple[dict[str, Array], int]]:
    """A table by its clock `t` (n,), each part with the number of its rows that were left out.

    Stray rows are left out, and those without any number. Without stray ones it has parts where the clock
    starts again from its first stamp. A part whose clock stands was never written.
    """
    empty = np.all([np.isnan(x) for x in raw.values()], axis=0)
    if empty.any() and not empty.all():
        (one, left), *others = parts_of_clock({name: x[~empty] for name, x in raw.items()}, t[~empty])
        return [(one, left + int(empty.sum())), *others]
    kept = in_order(t)
    if len(kept) < len(t):
        return [({name: x[kept] for name, x in raw.items()}, len(t) - len(kept))]
    back = np.flatnonzero(np.diff(t) < 0) + 1
    if not len(back) or np.any(np.abs(t[back] - t[0]) > FROM_THE_FIRST * np.median(np.abs(np.diff(t)))):
        return [(raw, 0)]
    edges = list(itertools.pairwise([0, *back, len(t)]))
    moving = [(a, b) for a, b in edges if t[a] < t[b - 1]] or edges
    return [({name: x[a:b] for name, x in raw.items()}, 0) for a, b in moving]


def parts_of_label(raw: dict[str, Array], label: Array, t: Array | None) -> list[dict[str, Array]]:
    """A table's parts over which `label` (n,) keeps its value. A row without one belongs to the run before.

    A long gap of the clock `t` (n,), where there is one, parts rows as well, and sensors keep their zeros.
    """
    known = np.flatnonzero(~np.isnan(label))
    new = known[1:][np.diff(label[known]) != 0]
    if t is not None and len(new):
        new = new[~(t[new] - t[new - 1] > LONG_GAP * np.nanmedian(np.diff(t)))]
    edges = itertools.pairwise([0, *new, len(label)])
    return [{name: x[a:b] for name, x in raw.items()} for a, b in edges]


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
