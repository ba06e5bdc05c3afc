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
from calibration.statistics.whitening import Mask

SLOW = "slow_offset"  # label of these columns: nuisances, in no report's table
FEWEST, MOST = 2, 12  # half periods of a file: they and the mean leave a quarter, a twentieth of a walk
STROKES = 2  # moves that the shortest half period lasts, where there are enough: faster, it is the direction
# of the held-out mean square, that slow functions of a file's own time take off beyond what any smooth
# function of the motion predicts there (ASSUMPTION: a fifth)
TELLING = 0.2
PERIODS = 2.0  # of a file, before a period can be told from a walk
LINE = 2.0  # times what they leave: one slow line that leaves no more is no walk (ASSUMPTION)


def slow_columns(view: View, held: Mask, order: int) -> Array:
    """(n_fitted, k): mean and cosines of every file, `order` in a whole one; of its fitted and held-out rows
    apart, as nothing of the one says where the other's offset is."""
    file, t = view.file[view.rows], view.t[view.rows]
    out = []
    for k in np.unique(file):
        whole = np.ptp(t[file == k])
        for part in (~held, held):
            mine = (file == k) & part
            if not mine.any():
                continue
            begin, length = float(t[mine].min()), max(float(np.ptp(t[mine])), 1e-300)
            count = max(round(order * length / max(whole, length)), 1)
            out += [np.where(mine, np.cos(np.pi * j * (t - begin) / length), 0.0) for j in range(count + 1)]
    return np.column_stack(out)


def with_slow_offset(p: Problem, view: View, order: int) -> Problem:
    """The same balance with an offset that wanders; `order` 0 changes nothing."""
    if not order:
        return p
    columns = slow_columns(view, p.held, order)
    fresh = columns if p.fresh is None else np.hstack([p.fresh, columns])
    means = np.flatnonzero(np.all((columns == 0) | (columns == 1), axis=0) & columns[~p.held].any(axis=0))
    columns = np.delete(columns, means[:1], axis=1)  # the first file's mean is the offset itself
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
    slow = slow_columns(view, problem.held, order)
    sign = np.sign(view.direction[view.rows])[:, None]
    none = np.zeros((len(problem.y), 0))
    left, before = _held(problem, none, slow), _held(problem, none, none)
    others = (before, _held(problem, flexible, none), _held(problem, none, slow * sign))
    if left > (1 - TELLING) * min(others) or _line(view, problem, order) < LINE * left:
        return 0, 0.0
    return order, float(np.sqrt(before - left))


def _held(p: Problem, fixed: Array, fresh: Array) -> float:
    """Mean square on held-out rows beside the base with `fixed` and `fresh` columns, these fitted anew."""
    x, rows = np.hstack([p.base, fixed, fresh]), p.train
    beta = solve(x[rows], p.y[rows])
    e, f = p.y[p.test] - x[p.test] @ beta, fresh[p.test]
    return float(np.mean((e - f @ solve(f, e)) ** 2))


def _line(view: View, p: Problem, order: int) -> float:
    """The same beside the base and one slow line, of the amplitude that it has on fitted rows and a phase of
    its own: a force that comes and goes with a period is a disturbance, and no walk."""
    t, one = view.t[view.rows], np.ones(len(p.y))
    file = view.file[view.rows]
    span = max(float(np.ptp(t[file == k])) for k in np.unique(file))
    best, out = np.inf, np.inf
    rows = p.train
    for rate in np.arange(PERIODS, order / 2 + 0.01, 1 / 16) / span:
        wave = np.column_stack([np.cos(2 * np.pi * rate * t), np.sin(2 * np.pi * rate * t)])
        own = [np.where((file == k)[:, None], wave, 0.0) for k in np.unique(file[rows])]
        x = np.hstack([p.base, *own])
        beta = solve(x[rows], p.y[rows])
        left = float(np.mean((p.y[rows] - x[rows] @ beta) ** 2))
        if left >= best:
            continue
        size = np.median(np.hypot(*beta[p.base.shape[1] :].reshape(-1, 2).T))
        n = p.base.shape[1]
        e = p.y[p.test] - p.base[p.test] @ beta[:n]
        free = np.column_stack([wave, one])[p.test]
        found = solve(free, e)
        found[:2] *= size / max(float(np.hypot(found[0], found[1])), 1e-300)
        best, out = left, float(np.mean((e - free @ found) ** 2))
    return out
