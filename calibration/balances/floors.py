"""Noise floors: what is left of a balance when everything is known, measured apart from the fit."""

import numpy as np
from scipy.stats import norm

from calibration.arrays import Array, Mask
from calibration.balances.balance import response_of
from calibration.balances.filters import Filter, smooth
from calibration.balances.friction import sliding_of
from calibration.balances.motion import Motion
from calibration.balances.noise import ROUNDING, column_noise, position_noise, rough
from calibration.balances.problem import Problem
from calibration.balances.repeats import repeat_lag, stroke_scatter
from calibration.balances.torque import Transmission
from calibration.balances.view import View
from plant.units import ARCSEC

FEWEST = 50  # rows that have a partner. ASSUMPTION
AGREE = 0.005  # of the range, that a repeated motion may differ from the first. ASSUMPTION
# of a step, where a sensor's zero may lie: distances of the two zeros of 0.2 to 0.8 (ASSUMPTION)
ORIGINS = (0.1, 0.3, 0.6, 0.8)
# counts per row: a tachometer that is slower keeps its rounding error from row to row. ASSUMPTION
OWN_COUNT = 0.5


def floor_of(view: View, p: Problem) -> tuple[float | None, str]:
    """rms, never from the fit of an effect, and its source. The source is repeats of the motion, or the
    columns' noise, which volts hold as their floor already. None when neither can be estimated."""
    # what the declared terms leave: motion that differs a little from turn to turn is taken out so
    e = np.where(p.valid, p.plain_fit(p.valid)[1], np.nan)
    again = None if view.dynamic else stroke_scatter(view, e)
    if again is not None:
        return again, "strokes that are made again, place by place"
    lag = repeat_lag(view)
    if (lag and lag % max(view.step, 1) <= 1) or lag > 50 * max(view.step, 1):
        found = _by_lag(view, p, e, round(lag / max(view.step, 1)))
        if found is not None:
            return found, f"repeats of the motion every {lag * view.period_s:.4g} s"
    volts = p.channel == "E"
    noise = (p.floor or None) if volts else sensors_floor(view, p)
    if noise is not None:
        travel = "" if volts else ", and travel that the position does not resolve"
        return noise, f"the columns' noise from row to row{travel}"
    return None, "the motion does not repeat itself, and the columns' noise cannot be estimated"


def _by_lag(view: View, p: Problem, e: Array, lag: int) -> float | None:
    if lag < 1 or lag >= len(e):
        return None
    x = view.x[view.rows]
    d, dx = e[lag:] - e[:-lag], x[lag:] - x[:-lag]
    same = (p.session[lag:] == p.session[:-lag]) & np.isfinite(d)
    if same.sum() < FEWEST or np.sqrt(np.mean(dx[same] ** 2)) > AGREE * float(np.ptp(x)):
        return None
    return float(np.sqrt(np.mean(d[same] ** 2) / 2))


def sensors_floor(view: View, p: Problem) -> float | None:
    """rms of the column's noise, the position's through the inertia, and friction in travel that it does not
    resolve. None where the log is too short."""
    r = view.response
    if not r.is_force:
        return _of_two(view)
    if r.channel == "acceleration":
        own = view.columns.get("acceleration")
        return _bent(view, view.filter) * abs(r.gain) if own is None else passed(view, own * r.gain)
    known, turning = _of_force(view, p)
    if known is None or turning is None:
        return known
    return float(np.hypot(known, np.sqrt(np.mean(turning[p.valid] ** 2))))


def resolved_rows(view: View, p: Problem) -> tuple[Mask, float] | None:
    """Rows that a position's steps spoil less than the noise, and its rms there; None without steps."""
    if not view.response.is_force or view.response.channel == "acceleration":
        return None
    known, turning = _of_force(view, p)
    return None if known is None or turning is None else (p.valid & (np.abs(turning) < known), known)


def passed(view: View, full: Array, beside: Array | None = None) -> float | None:
    """A column's white noise behind the filter, the median over files.

    beside: the position, where its own steps come back in the column through a loop, as real force.
    """
    every = view.seldom.get(view.response.channel, 1)  # between its readings a column is a straight line
    found = [
        rough(full[rows], 2, None if beside is None else beside[rows])
        for rows in (np.flatnonzero(view.file == k)[::every] for k in np.unique(view.file))
    ]
    good = [x for x in found if np.isfinite(x)]
    return float(np.median(good) * np.sqrt(min(view.filter.passes * every, 1.0))) if good else None


def _bent(view: View, by: Filter) -> float:
    """The position's noise as an acceleration behind a filter."""
    return view.noise * float(np.sqrt(by.bends)) / view.period_s**2


def _of_force(view: View, p: Problem) -> tuple[float | None, Array | None]:
    """rms of the force's column and of the position through the inertia. The second value (n_fitted,) is
    friction whose direction the position's noise leaves open after a reversal, less what the declared terms
    take of it. None for what is not estimated."""
    declared, _ = p.plain_fit(p.train)
    loop = None if view.response.is_speed else view.x  # no loop makes a speed, the position is its own
    own = passed(view, response_of(view, 0.0)[0], loop)
    step = view.quanta.get(view.response.channel, 0.0) * abs(view.response.gain)
    if own is not None and not view.response.divide_by:  # a held or slow column hides its rounding
        own = max(own, step * ROUNDING * float(np.sqrt(view.filter.passes)))
    bent = abs(declared.get("inertia", 0.0)) * _bent(view, Filter(view.wide))
    known = None if own is None else float(np.hypot(own, bent))
    coulomb, noise = declared.get("coulomb", 0.0), view.noise
    if coulomb <= 0 or noise <= 0 or not view.dynamic or not p.valid.any():
        return known, None
    # the chance that noise of two places, here and where it turned, hides the way; friction is then twice off
    wrong = norm.cdf(-np.abs(view.since) / (np.sqrt(2.0) * noise))
    column = 2 * coulomb * view.at(np.sqrt(wrong) * sliding_of(view).steady)
    # of all rows that are judged: what is refitted on held-out rows is not told by the others
    beta = np.linalg.lstsq(p.base[p.valid], column[p.valid], rcond=None)[0]
    return known, np.asarray(column - p.base @ beta)


def _of_two(view: View) -> float | None:
    """Noise of two position sensors, or their rounding, which the filter does not average on one step."""
    second = view.columns.get(view.response.channel)
    if second is None:
        return None
    gain, ratio = abs(view.response.gain), abs(view.response.ratio or 1.0)
    steps = view.quanta.get("position"), view.quanta.get(view.response.channel)
    own = position_noise(second, view.file, steps[1])
    noise = float(np.hypot(own * gain, ratio * view.noise))
    if view.sigma <= 0 or steps == (None, None):
        return noise * float(np.sqrt(view.filter.passes))
    path = smooth(view.x, view.segment, 2 * view.sigma)  # the log's own motion, rounded from other origins
    squares = []
    for origin in ORIGINS:
        one, two = _rounded(path, steps[0], origin), _rounded(path * ratio / gain, steps[1], 1.0 - origin)
        squares.append(float(np.var(view.at(gain * two - ratio * one))))
    return max(noise * float(np.sqrt(view.filter.passes)), float(np.sqrt(np.mean(squares))))


def _rounded(path: Array, step: float | None, origin: float) -> Array:
    """Rounding of a path by a sensor whose zero is `origin` of a step away; none of a computed command."""
    if step is None:
        return np.zeros(len(path))
    at = path / step + origin
    return np.asarray((np.round(at) - at) * step)


def floors_of_pair(
    m: Motion, drive: Transmission, held: Mask, inertia: float, resistance: float
) -> dict[str, float]:
    """Per channel, rms that noise and quanta leave of an axis with two motors, where it has the columns."""
    frame, n, out = m.frame, column_noise(m.frame), {}
    second = np.zeros(2 * m.width + 1)  # over the rows of one means of the position, per s2
    second[[0, m.width, -1]] = np.array([1.0, -2.0, 1.0]) / m.cell_s**2
    currents = [n[k] for k in ("current_a", "current_b") if k in n]
    averaged, squares = m.filter.passes, [s**2 for s in currents]
    if squares:
        # both currents through the motors, the trains' curvature and the averaging; the position through the
        # inertia
        through = np.pad(m.filter.weights, 1) - drive.softness_s2 * second
        force = drive.per_ampere**2 * float(np.sum(through**2)) * sum(squares)
        out["T"] = float(np.sqrt(force + (inertia * n["position"]) ** 2 * float(np.sum(second**2))))
        # a current through the resistance (the rate's noise through the constant is a thousandth of it), and
        # the effort of the tick between two rows, which is not logged: half of a row's volts are of that tick
        both = 1 + frame.scale["counter_torque"] ** 2
        between = (frame.scale["supply_V"] * n.get("effort", 0.0)) ** 2 / 2 * both / 2
        out["E"] = float(np.sqrt(averaged * (resistance**2 * float(np.mean(squares)) + between)))
    # the tachometers' rounding, averaged where they count quickly enough, the absolute encoder and what the
    # currents' noise makes of the trains' wind-up
    turn = frame.scale["tach_counts_per_turn"] * frame.scale["gear_ratio"]
    rate = np.abs(m.speed[m.rows][(held & m.ok)[m.rows]])
    quick = rate / (2 * np.pi) * turn * frame.period_s > OWN_COUNT
    share = float(np.mean(np.where(quick, averaged, 1.0))) if len(quick) else 1.0
    wind = max(currents, default=0.0) * drive.per_ampere / drive.stiffness
    count = 2 * np.pi / turn * ROUNDING
    out["K"] = float(np.sqrt(share * count**2 + averaged * (n["position"] ** 2 + wind**2)) / ARCSEC)
    if "velocity" in n:
        out["S"] = float(n["velocity"] * np.sqrt(averaged) / ARCSEC)
    return out
