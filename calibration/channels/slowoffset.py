"""The offset of an effort that wanders: an amplifier's zero, a load cell's creep.

A walk of the offset is no effect of the drive, but along a few moves it follows the direction by chance, and
everything that starts at some time follows it, too. Slow functions of time then stand in the balance as the
offset does: fitted anew in every file, the held-out one as well.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.channels.problem import Problem
from calibration.channels.view import View, pieces
from calibration.readers.run import Array
from calibration.statistics.regression import solve

SLOW = "slow_offset"  # label of these columns: nuisances, in no report's table
FEWEST, MOST = 2, 12  # half periods of a file: they and the mean leave a quarter, a twentieth of a walk
STROKES = 2  # moves that the shortest half period lasts, where there are enough: faster, it is the direction
# of the held-out mean square, that slow functions of a file's own time take off beyond what any smooth
# function of the motion predicts there (ASSUMPTION: a fifth)
TELLING = 0.2


def slow_columns(view: View, order: int) -> Array:
    """(n_fitted, files * (order + 1)): mean and `order` cosines of every file."""
    file, t = view.file[view.rows], view.t[view.rows]
    out = []
    for k in np.unique(file):
        mine = file == k
        begin, end = float(t[mine].min()), float(t[mine].max())
        phase = np.pi * (t - begin) / max(end - begin, 1e-300)
        out += [np.where(mine, np.cos(j * phase), 0.0) for j in range(order + 1)]
    return np.column_stack(out)


def with_slow_offset(p: Problem, view: View, order: int) -> Problem:
    """The same balance with an offset that wanders; `order` 0 changes nothing."""
    if not order:
        return p
    columns = slow_columns(view, order)
    fresh = columns if p.fresh is None else np.hstack([p.fresh, columns])
    first = int(p.session[p.train][0]) if p.train.any() else 0
    mean = int(np.searchsorted(np.unique(view.file[view.rows]), first)) * (order + 1)
    columns = np.delete(columns, mean, axis=1)  # that file's mean is the offset itself
    labels = [*p.base_labels, *[(SLOW, view.unit)] * columns.shape[1]]
    return replace(p, base=np.hstack([p.base, columns]), base_labels=labels, fresh=fresh)


def slowness(view: View) -> int:
    """Cosines per file: none faster than STROKES moves of the file that has fewest."""
    moves = []
    for a, b in pieces(view.file):
        way = np.sign(np.where(np.abs(view.direction[a:b]) > 0.5, view.direction[a:b], 0.0))
        moves.append(int(np.sum(np.diff(way[way != 0]) != 0)))
    return int(np.clip(min(moves, default=0) // STROKES, FEWEST, MOST))


def offset_order(view: View, problem: Problem, flexible: Array) -> tuple[int, float]:
    """Cosines per file that the offset needs (0: it stands still), and the rms of what they take away.

    `flexible` (n_fitted, k): what drives may leave along their motion. Effects follow the motion, and most of
    them its direction: what only slow functions of time predict on held-out rows, with no direction, is none.
    """
    rows, order = problem.test, slowness(view)
    if rows.sum() < 20 * (order + 1) or problem.train.sum() < 20 * flexible.shape[1]:
        return 0, 0.0
    slow = slow_columns(view, order)
    sign = np.sign(view.direction[view.rows])[:, None]
    none = np.zeros((len(problem.y), 0))
    e = _held(problem, none, slow)
    others = (_held(problem, flexible, none), _held(problem, none, slow * sign))
    if np.mean(e**2) > (1 - TELLING) * min(float(np.mean(x**2)) for x in others):
        return 0, 0.0
    return order, float(np.sqrt(np.mean(_held(problem, none, none) ** 2) - np.mean(e**2)))


def _held(p: Problem, fixed: Array, fresh: Array) -> Array:
    """What is left of held-out rows by the base with `fixed` and `fresh` columns, the latter fitted anew."""
    x, rows = np.hstack([p.base, fixed, fresh]), p.train
    beta = solve(x[rows], p.y[rows])
    e, f = p.y[p.test] - x[p.test] @ beta, fresh[p.test]
    return np.asarray(e - f @ solve(f, e))
