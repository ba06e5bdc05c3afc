"""What is left of a balance when everything is known: measured apart from the fit."""

from __future__ import annotations

import numpy as np

from calibration.channels.problem import Problem
from calibration.channels.repeats import repeat_lag
from calibration.channels.view import View
from calibration.readers.run import Array

FEWEST = 50  # rows that have a partner
BINS = 200  # of a stage's turn
AGREE = 0.005  # of the range, that a repeated motion may differ from the first


def floor_of(view: View, problem: Problem) -> tuple[float | None, str]:
    """rms and how it was had: repeats of the same motion, repeats of the same place, or None."""
    e = _plain_residual(problem)
    lag = repeat_lag(view)
    if (lag and lag % max(view.step, 1) <= 1) or lag > 50 * max(view.step, 1):
        found = _by_lag(view, problem, e, round(lag / max(view.step, 1)))
        if found is not None:
            return found, f"repeats of the motion every {lag * view.period_s:.4g} s"
    period = min((g.period for g in view.rig.stages if g.period), default=0.0)
    if period and problem.channel == "T":
        found = _by_place(view, problem, e, period)
        if found is not None:
            return found, f"repeats of the same place of a turn, {BINS} to a turn"
    return None, "the motion does not repeat itself"


def _plain_residual(p: Problem) -> Array:
    """What the declared terms leave; motion that differs a little from turn to turn is taken out so."""
    rows = p.valid
    beta = np.linalg.lstsq(p.base[rows], p.y[rows], rcond=None)[0]
    return np.asarray(np.where(rows, p.y - p.base @ beta, np.nan))


def _by_lag(view: View, p: Problem, e: Array, lag: int) -> float | None:
    if lag < 1 or lag >= len(e):
        return None
    x = view.x[view.rows]
    d, dx = e[lag:] - e[:-lag], x[lag:] - x[:-lag]
    same = (p.session[lag:] == p.session[:-lag]) & np.isfinite(d)
    if same.sum() < FEWEST:
        return None
    if float(np.sqrt(np.mean(dx[same] ** 2))) > AGREE * float(np.ptp(x)):
        return None
    return float(np.sqrt(np.mean(d[same] ** 2) / 2))


def _by_place(view: View, p: Problem, e: Array, period: float) -> float | None:
    """Pooled scatter within fine bins of place and direction."""
    x = view.x[view.rows]
    key = np.floor((x % period) / period * BINS) * 3 + np.sign(view.direction[view.rows]) + 1
    rows = np.isfinite(e)
    _, label, count = np.unique(key[rows], return_inverse=True, return_counts=True)
    mean = np.bincount(label, e[rows]) / count
    many = count[label] >= 3
    if many.sum() < FEWEST:
        return None
    scatter = (e[rows] - mean[label]) ** 2 * count[label] / np.maximum(count[label] - 1, 1)
    return float(np.sqrt(np.mean(scatter[many])))
