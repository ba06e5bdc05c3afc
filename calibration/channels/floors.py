"""What is left of a balance when everything is known: measured apart from the fit."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from calibration.channels.drivenoise import sensors_floor
from calibration.channels.problem import Problem
from calibration.channels.repeats import repeat_lag
from calibration.channels.strokes import stroke_scatter
from calibration.channels.view import View
from calibration.readers.run import Array

FEWEST = 50  # rows that have a partner
AGREE = 0.005  # of the range, that a repeated motion may differ from the first


def floor_of(
    view: View, problem: Problem, noise_of: Callable[[], float | None] | None = None
) -> tuple[float | None, str]:
    """rms and how it was had: repeats of the same motion, or what the columns' own noise leaves (`noise_of`,
    where they are others than a force's and a position's); None when neither can be told. Never from the fit
    of an effect."""
    e = _plain_residual(problem)
    again = None if view.dynamic else stroke_scatter(view, e)
    if again is not None:
        return again, "strokes that are made again, place by place"
    lag = repeat_lag(view)
    if (lag and lag % max(view.step, 1) <= 1) or lag > 50 * max(view.step, 1):
        found = _by_lag(view, problem, e, round(lag / max(view.step, 1)))
        if found is not None:
            return found, f"repeats of the motion every {lag * view.period_s:.4g} s"
    noise = noise_of() if noise_of is not None else sensors_floor(view, problem)
    if noise is not None:
        travel = "" if noise_of is not None else ", and travel that the position does not resolve"
        return noise, f"the columns' noise from row to row{travel}"
    return None, "the motion does not repeat itself, and the columns' noise cannot be told"


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
