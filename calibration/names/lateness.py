"""A late effort: looked for before friction, beside a fit that is flexible enough not to mistake one for the
other."""

from __future__ import annotations

import numpy as np

from calibration.decide.finding import Finding, Parameter
from calibration.names import stribeck_change
from calibration.names.scene import Scene
from calibration.names.unknown import plain
from calibration.readers.run import Array
from calibration.statistics.regression import block_covariance

SIGNIFICANT = 5.0  # standard errors
MATTERS = 0.03  # of the mean square on held-out rows, beside the flexible fit
SMALLEST = 0.2  # sample periods: a shorter one is within the hold of the output
LONGEST = 25.0  # sample periods that are looked at
ROUNDS = 4


def effort_delay(s: Scene) -> Finding | None:
    """The delay of the response's column against the motion, positive when it tells of earlier times."""
    p, v = s.problem, s.view
    r = v.response
    if p.train.sum() < 20 * p.base.shape[1]:
        return None
    full = v.columns[r.channel] * r.gain
    if r.divide_by:
        return None
    known = p.y - s.at(full)  # what constants took off
    reach = LONGEST * v.period_s
    delay, error = 0.0, np.inf
    for _ in range(ROUNDS):
        y = s.at(v.delayed(full, delay)) + known
        step, error = _step(s, y)
        delay = float(np.clip(delay + step, -reach, reach))
        if abs(step) < 0.01 * v.period_s:
            break
    if not abs(delay) > max(SIGNIFICANT * error, SMALLEST * v.period_s) or abs(delay) >= reach:
        return None
    before, after = _left(s, p.y), _left(s, s.at(v.delayed(full, delay)) + known)
    share = 1 - (after / before) ** 2
    if share < MATTERS or any(_left(s, p.y, rival) < after for rival in _rivals(s)):
        return None
    half = 1.96 * error
    word = "late" if delay > 0 else "early"
    return Finding(
        "channel_delay",
        "S",
        "clock",
        evidence=(delay / error) ** 2 / 4.6,
        share=share,
        note=f"the {r.channel} column is {word} against the position",
        parameters={"delay": Parameter(delay, "s", delay - half, delay + half)},
    )


def _columns(s: Scene, more: Array | None = None) -> Array:
    x = np.hstack([s.problem.base, plain(s), *([] if more is None else [more])])
    size = np.linalg.norm(x[s.problem.train], axis=0)
    return np.asarray(x[:, size > 0] / size[size > 0])


def _step(s: Scene, y: Array) -> tuple[float, float]:
    """Delay that is left in y, and its standard error: the coefficient of the fitted force's rate."""
    p, v = s.problem, s.view
    x = _columns(s)
    rows = p.train
    beta = np.linalg.lstsq(x[rows], y[rows], rcond=1e-8)[0]
    model = x @ beta
    rate = np.gradient(model) / p.period_s
    rate[1:][np.diff(p.session) != 0] = 0.0
    full = np.column_stack([x, -rate])
    found = np.linalg.lstsq(full[rows], y[rows], rcond=1e-8)[0]
    e = y[rows] - full[rows] @ found
    cov = block_covariance(full[rows], e, p.block)
    return float(found[-1]), float(np.sqrt(max(cov[-1, -1], 0.0)))


def _rivals(s: Scene) -> list[Array]:
    """Friction over the speed, which along one kind of ramp looks like a delay."""
    v = s.view
    out = [c.columns for c in stribeck_change.columns(s)]
    return [*out, s.at(v.speed * np.abs(v.speed))[:, None]]


def _left(s: Scene, y: Array, more: Array | None = None) -> float:
    """rms on held-out rows of a fit with loops, asymmetry and weight, and `more`."""
    p = s.problem
    x = _columns(s, more)
    beta = np.linalg.lstsq(x[p.train], y[p.train], rcond=1e-8)[0]
    rows = p.test if p.test.sum() > 20 else p.train
    return float(np.sqrt(np.mean((y - x @ beta)[rows] ** 2)))
