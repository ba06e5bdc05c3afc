"""One stretch of a file that does not obey what the rest obeys: a push by hand, a foot against the bench.

It spoils every number that is fitted with it. So it is left out, and said, where that predicts held-out rows
far better.
"""

from dataclasses import replace

import numpy as np
from scipy.ndimage import binary_dilation, label, sum_labels

from calibration.arrays import Array, Mask, by_median
from calibration.balances.floors import floor_of
from calibration.balances.problem import Problem
from calibration.balances.view import View
from calibration.decide.heldout import Model
from calibration.decide.selection import Selection
from calibration.decide.thresholds import CLEAR_SHARE, PLAINLY, STILL_MISSING
from calibration.finding import UNKNOWN, Finding
from calibration.look.delay import Make
from calibration.look.search import scene_of
from calibration.statistics.regression import solve

# robust deviations of a row that does not obey. ASSUMPTION: friction's corners and worn teeth stay below
FAR = 8.0
# of the largest residual, where an event begins and ends. ASSUMPTION
SLOPES = 0.1
# of the fitted rows, that an event holds at most. ASSUMPTION: more is a part of the motion
SHORT = 0.1
# refits with weights 1 / residual: least absolute deviations to some per cent. arithmetic
ROUNDS = 20


def leave_out_event(view: View, made: Make, s: Selection) -> Finding | None:
    """The event, whose rows are no longer `ok` in the view; None where names of `s` explain the log, or where
    there is none. made: the balance by a delay, s."""
    p = made(0.0)
    floor = floor_of(view, p.once)[0] or 0.0
    left = max(s.held.after, float(np.sqrt(s.fitted_square)))
    if left <= STILL_MISSING * floor or not (p.train.any() and p.test.any()):
        return None
    x = np.column_stack([p.base, scene_of(view, p).wander])
    known = view.rig.constants.get("coulomb", 0.0)
    friction = abs(p.plain_fit(p.train)[0].get("coulomb", known))  # that turns leaves twice itself at most
    event = _stretches(p, x, max(STILL_MISSING * floor, 2 * friction))
    if not event.any():
        return None
    every, rest = (_usual(p, x, event, out) for out in (np.zeros_like(event), event))
    if not rest < (1 - PLAINLY) * every:
        return None
    reach, ok, said = int(3 * view.sigma) + 1, view.ok.copy(), list[str]()
    for k in np.unique(p.session[event]):
        first, last = view.rows[np.flatnonzero(event & (p.session == k))[[0, -1]]]
        ok[max(first - reach, 0) : last + reach + 1] = False
        said.append(f"{view.t[first]:.4g} to {view.t[last]:.4g} s of file {int(k) + 1}")
    view.ok = ok
    note = f"from {', '.join(said)} only: these rows are left out"
    return Finding(UNKNOWN, p.channel, "time", share=1 - rest / every, note=note)


def _stretches(p: Problem, x: Array, least: float) -> Mask:
    """The rows (n,) of one stretch a file, of those that hold most of what columns x (n, k) leave there.

    None where they are not short, do not hold most of all files' together, or have an rms below the least.
    Of files in turn every row is fitted. Else a stretch may go on into held-out rows.
    """
    e = p.y - x @ _robust(x[p.train], p.y[p.train])
    square, size = np.where(p.train, e**2, 0.0), np.where(p.valid, np.abs(e), 0.0)
    largest = float(np.max(size[p.train], initial=0.0))
    far = size > max(FAR * by_median(e[p.train]), SLOPES * largest)
    event = np.zeros(len(far), dtype=bool)
    for k in np.unique(p.session[far]):
        mine = p.session == k
        stretches, count = label(binary_dilation(far & mine, iterations=p.block))
        most = 1 + int(np.argmax(sum_labels(square, stretches, range(1, count + 1))))
        at = np.flatnonzero(far & mine & (stretches == most))
        rows = np.arange(at[0], at[-1] + 1)
        holds_most = float(square[rows].sum()) > CLEAR_SHARE * float(square[mine].sum())
        event[rows] = holds_most and float(np.mean(size[at] ** 2)) > least**2
    holds_most = float(square[event].sum()) > CLEAR_SHARE * float(square.sum())
    return event if holds_most and event.sum() < SHORT * p.train.sum() else np.zeros_like(event)


def _robust(x: Array, y: Array) -> Array:
    """Coefficients (k,) of the fit with the least sum of absolute residuals."""
    beta = solve(x, y)
    for _ in range(ROUNDS):
        e = np.abs(y - x @ beta)
        weight = 1.0 / np.sqrt(np.maximum(e, 0.1 * max(float(np.median(e)), 1e-300)))
        beta = solve(x * weight[:, None], y * weight)
    return beta


def _usual(p: Problem, x: Array, event: Mask, out: Mask) -> float:
    """Usual square beside columns x (n, k), fitted without the rows `out`, on held-out rows that are not the
    event's: they may hold another one."""
    q = replace(p, valid=p.valid & ~out, slow=False)
    left = Model(x=x, beta=solve(x[q.train], q.y[q.train])).left_out(q)[~event[q.test]]
    return by_median(left) ** 2 if len(left) else float("nan")
