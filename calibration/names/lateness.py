"""A late effort: looked for before friction, beside a fit that mistakes neither for the other."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from calibration.arrays import Array
from calibration.finding import NORMAL, Finding
from calibration.names import stribeck_change
from calibration.names.channel_delay import NAME as DELAY
from calibration.names.channel_delay import against_position, late_column
from calibration.names.scene import Scene
from calibration.names.unknown import any_friction_curve, plain
from calibration.statistics.regression import block_covariance
from calibration.statistics.tails import rms

SIGNIFICANT = 5.0  # standard errors. ASSUMPTION
MATTERS = 0.02  # of the mean square on held-out rows, beside the flexible fit. ASSUMPTION
# of the same, from where on a delay is noted: 16 logs without one had 0.3 % at most (development seeds 1031
# to 1038, 1062, 1063)
TOLD = 0.005
SMALLEST = 0.2  # sample periods: a shorter one is within the hold of the output. ASSUMPTION
LONGEST = 25.0  # sample periods that are looked at: a clock is late by rows. ASSUMPTION
# likewise: a transport is late by its own time (serial and USB adapters 1 to 50 ms; ASSUMPTION: twice that)
LONGEST_S = 0.1
ROUNDS = 5  # rounds of the refinement at most. ASSUMPTION
SMALL_STEP = 0.01  # of a sample period: steps of the refinement that end it. ASSUMPTION
STARTS = 41  # values of the delay that are tried before it is refined; zero is one of them. ASSUMPTION
# periods: half a period, and what friction's memory adds to it (0.56 at an error of 0.001 in the opened seed
# 20261210); EMPS' delay is 0.72 periods
HOLD = 0.6
SLACK = 3.0  # standard errors beyond it. ASSUMPTION
QUICK = 0.2  # of the usual top speed, share: slower rows say nothing of a clock. ASSUMPTION
PARTS = 5  # pieces of the log, in each of which the delay must be seen. ASSUMPTION
FEWEST_HELD = 20  # rows that are held out, before they are looked at. ASSUMPTION
ALIKE = 0.35  # of the delay: standard deviation over those pieces. ASSUMPTION


def effort_delay(s: Scene, lines: Array) -> tuple[Finding | None, str]:
    """The delay of the response's column against the motion, positive when it tells of earlier times. Where
    one stands clear of its error but changes next to nothing, also what would be needed to tell.

    It is looked for beside `lines` (n_fitted, k), loops, asymmetry, weight and friction over the speed. Its
    size is then taken beside a friction curve of any smooth shape, where that can be distinguished from it.
    """
    v = s.view
    # without the rows near rest: there friction turns, which looks late or early by itself
    quick = s.problem.valid & (np.abs(v.speed[v.rows]) > QUICK * v.top)
    s = replace(s, problem=replace(s.problem, valid=quick))
    p, r = s.problem, v.response
    if p.train.sum() < 20 * p.base.shape[1] or r.divide_by:
        return None, ""
    full = v.columns[r.channel] * r.gain
    known = p.y - s.at(full)  # what constants took off

    def late(delay: float) -> Array:
        return s.at(v.delayed(full, delay)) + known

    # beside the friction over the speed that explains most: along one kind of ramp it looks like a delay
    known_too = np.hstack([plain(s), lines])
    rivals = [*(c.columns for c in stribeck_change.columns(s)), s.at(v.speed * np.abs(v.speed))[:, None]]
    rival = min((np.hstack([known_too, r]) for r in rivals), key=lambda r: _left(s, p.y, r))
    delay, error = _converge(s, late, rival)
    reach = max(LONGEST * v.period_s, LONGEST_S)
    if not abs(delay) > max(SIGNIFICANT * error, SMALLEST * v.period_s) or abs(delay) >= reach:
        return None, ""
    before, after = _left(s, p.y, rival), _left(s, late(delay), rival)
    share = 1 - (after / before) ** 2
    if not _everywhere(s, late(delay), delay, rival):
        return None, ""
    if share < MATTERS:
        sound = share < TOLD or abs(delay) < HOLD * v.period_s + SLACK * error
        what = f"{DELAY.name} of {r.channel}, {1e3 * delay:.2g} +- {1e3 * error:.1g} ms, was close"
        took = f"it takes {100 * max(share, 0.0):.1f} % of the held-out mean square"
        return None, "" if sound else f"{what} ({took}): quicker turns and a quieter effort"
    curve = np.hstack([known_too, any_friction_curve(s)])
    finer, spread = _converge(s, late, curve)
    if spread < abs(finer) / SIGNIFICANT and finer * delay > 0:
        error = float(np.hypot(spread, (finer - delay) / 2))  # half of what the friction curve moves it by
        delay = finer
    return late_column(against_position(r.channel, delay), delay, error, share), ""


def is_hold(f: Finding, period_s: float) -> bool:
    """Whether a delay is what a sound sampled loop shows.

    An effort that is held for a period acts half a period after the position it was made from. That is half a
    period before the next position. Which of the two its row holds is the log writer's choice.
    """
    p = f.parameters["delay"]
    if p.low is None or p.high is None:
        return False
    error = (p.high - p.low) / 2 / NORMAL
    return bool(abs(p.value) < HOLD * period_s + SLACK * error)


def _converge(s: Scene, late: Callable[[float], Array], more: Array) -> tuple[float, float]:
    """The delay at which nothing of it is left, beside the declared terms and `more`; its standard error. It
    begins at the one of STARTS that fits best: a step is a tangent, which from far off leads elsewhere."""
    reach, rows = max(LONGEST * s.view.period_s, LONGEST_S), s.problem.train
    q, _ = np.linalg.qr(s.fitted(more)[0][rows])

    def left(delay: float) -> float:
        y = late(delay)[rows]
        return float(y @ y - np.sum((q.T @ y) ** 2))

    delay, error = float(min(np.linspace(-reach, reach, STARTS), key=left)), np.inf
    for _ in range(ROUNDS):
        step, error = _step(s, late(delay), more)
        delay = float(np.clip(delay + step, -reach, reach))
        if abs(step) < SMALL_STEP * s.view.period_s:
            break
    return delay, error


def _everywhere(s: Scene, y: Array, delay: float, more: Array) -> bool:
    """A clock is late by the same time in every part of the log; `y` is put right by `delay`."""
    p = s.problem
    x, fitted, rows = *s.fitted(more, y=y), p.train
    q, _ = np.linalg.qr(x[rows])
    e, d = (y - fitted)[rows], -_rate(s, fitted)[rows]
    d = d - q @ (q.T @ d)
    parts = np.array_split(np.arange(len(e)), PARTS)
    weight = np.array([float(d[k] @ d[k]) for k in parts])
    found = delay + np.array([float(d[k] @ e[k]) for k in parts]) / np.maximum(weight, 1e-300)
    telling = weight > 0.1 * weight.mean()  # a part in which nothing moves says nothing
    return bool(np.std(found[telling]) < ALIKE * abs(delay) and (found[telling] * delay > 0).all())


def _rate(s: Scene, model: Array) -> Array:
    rate = np.gradient(model) / s.problem.period_s
    rate[1:][np.diff(s.problem.session) != 0] = 0.0
    return np.asarray(rate)


def _step(s: Scene, y: Array, more: Array) -> tuple[float, float]:
    """Delay that is left in y, and its standard error: the coefficient of the fitted force's rate."""
    p, rows = s.problem, s.problem.train
    x, fitted = s.fitted(more, y=y)
    full = np.column_stack([x, -_rate(s, fitted)])
    found = np.linalg.lstsq(full[rows], y[rows], rcond=1e-8)[0]
    e = y[rows] - full[rows] @ found
    cov = block_covariance(full[rows], e, p.block)
    return float(found[-1]), float(np.sqrt(max(cov[-1, -1], 0.0)))


def _left(s: Scene, y: Array, more: Array) -> float:
    """rms of it on held-out rows."""
    p = s.problem
    return rms((y - s.fitted(more, y=y)[1])[p.test if p.test.sum() > FEWEST_HELD else p.train])
