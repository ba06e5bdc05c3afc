"""The offset of an effort that wanders: an amplifier's zero, a load cell's creep.

A walk follows the direction of a few moves by chance, and whatever starts at some time. Slow functions of
time then stand as the offset does: fitted anew in every file, the held-out one as well.
"""

from dataclasses import replace

import numpy as np

from calibration.arrays import Array, Mask
from calibration.balances.candidate import sine_columns
from calibration.balances.filters import pieces
from calibration.balances.problem import Problem
from calibration.balances.view import View
from calibration.statistics.regression import solve

SLOW = "slow_offset"  # label of these columns: nuisances, in no report's table
MOST = 12  # half periods of a file at most: a twentieth of a walk is left. ASSUMPTION
STROKES = 2  # moves in the shortest half period: faster, it is the motion, and the drive's. ASSUMPTION
# of the held-out mean square, that functions of a file's time take beyond those of the motion. ASSUMPTION
TELLING = 0.2
PERIODS = 2.0  # of a file, before a period can be told from a walk. ASSUMPTION
LINE = 2.0  # times what they leave: one slow line that leaves no more is no walk (ASSUMPTION)


def slow_columns(view: View, held: Mask, order: int) -> Array:
    """(n_fitted, k): mean and cosines per file, `order` in a whole one; fitted and held-out rows apart."""
    file, t = view.file[view.rows], view.t[view.rows]
    out = []
    for k in np.unique(file):
        whole = np.ptp(t[file == k])
        for mine in ((file == k) & part for part in (~held, held) if part[file == k].any()):
            begin, length = float(t[mine].min()), max(float(np.ptp(t[mine])), 1e-300)
            count = max(round(order * length / max(whole, length)), min(order, 1))
            out += [np.where(mine, np.cos(np.pi * j * (t - begin) / length), 0.0) for j in range(count + 1)]
    return np.column_stack(out)


def with_slow_offset(p: Problem, view: View, order: int | None) -> Problem:
    """The same balance with an offset that wanders, or is every file's own (`order` 0); None: it is one."""
    if order is None:
        return p
    columns = slow_columns(view, p.held, order)
    fresh = columns if p.fresh is None else np.hstack([p.fresh, columns])
    means = np.flatnonzero(np.all((columns == 0) | (columns == 1), axis=0) & columns[~p.held].any(axis=0))
    # the first file's mean is the offset itself, or every file's is its own
    columns = np.delete(columns, means[:1] if p.fresh is None else means, axis=1)
    labels = [*p.base_labels, *[(SLOW, view.unit)] * columns.shape[1]]
    return replace(p, base=np.hstack([p.base, columns]), base_labels=labels, fresh=fresh)


def slowness(view: View) -> int:
    """Cosines per file: none faster than STROKES moves of the file that has fewest."""
    moves = []
    for a, b in pieces(view.file):
        way = np.sign(np.where(np.abs(view.direction[a:b]) > 0.5, view.direction[a:b], 0.0))
        moves.append(int(np.sum(np.diff(way[way != 0]) != 0)))
    return min(min(moves, default=0) // STROKES, MOST)


def offset_order(view: View, problem: Problem, flexible: Array) -> tuple[int | None, float]:
    """Cosines per file that the offset needs, 0: every file's own constant, None: one constant for all. Also
    the rms of what they take away.

    `flexible` (n_fitted, k): what drives may leave. A walk is what only slow functions of time predict, a
    constant per file what neither they nor a friction per file do.
    """
    problem, order = problem.once, slowness(view) if view.dynamic else 0
    rows = problem.test
    if rows.sum() < 20 * (order + 1) or problem.train.sum() < 20 * flexible.shape[1]:
        return None, 0.0
    sign = np.sign(view.direction[view.rows])[:, None]
    none = np.zeros((len(problem.y), 0))
    before, bent = _held(problem, none, none), _held(problem, flexible, none)
    several = len(np.unique(problem.session[problem.valid])) > 1
    found, least = None, min(before, bent)
    for k in sorted({0, order} if several else {order} - {0}):
        slow = slow_columns(view, problem.held, k)
        left = _held(problem, none, slow)
        most = (1 - TELLING) * min(least, _held(problem, none, slow * sign))
        if left <= most and (k == 0 or _line(view, problem, order) >= LINE * left):
            found, least = k, left
    return found, float(np.sqrt(before - least))


def _held(p: Problem, fixed: Array, fresh: Array) -> float:
    """Mean square on held-out rows beside the base with `fixed` and `fresh` columns, these fitted anew."""
    x, rows = np.hstack([p.base, fixed, fresh]), p.train
    beta = solve(x[rows], p.y[rows])
    e, f = p.y[p.test] - x[p.test] @ beta, fresh[p.test]
    return float(np.mean((e - f @ solve(f, e)) ** 2))


def _line(view: View, p: Problem, order: int) -> float:
    """The same beside one slow line of its fitted amplitude and a new phase: with a period it is no walk."""
    t, file = view.t[view.rows], view.file[view.rows]
    span = max(float(np.ptp(t[file == k])) for k in np.unique(file))
    best, out = np.inf, np.inf
    rows = p.train
    for rate in np.arange(PERIODS, order / 2 + 0.01, 1 / 16) / span:
        x = np.hstack([p.base[rows], sine_columns(rate * t[rows], file[rows])])
        beta, n = solve(x, p.y[rows]), p.base.shape[1]
        left = float(np.mean((p.y[rows] - x @ beta) ** 2))
        if left >= best:
            continue
        size = np.median(np.hypot(*beta[n:].reshape(-1, 2).T))
        e = p.y[p.test] - p.base[p.test] @ beta[:n]
        free = np.column_stack([sine_columns(rate * t, 0 * file), np.ones(len(t))])[p.test]
        found = solve(free, e)
        found[:2] *= size / max(float(np.hypot(found[0], found[1])), 1e-300)
        best, out = left, float(np.mean((e - free @ found) ** 2))
    return out
