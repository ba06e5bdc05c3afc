"""A late effort: looked for before friction, beside a fit that is flexible enough not to mistake one for the
other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from calibration.finding import Finding, Parameter
from calibration.names import stribeck_change
from calibration.names.scene import Scene
from calibration.names.unknown import any_friction_curve, plain
from calibration.readers.run import Array
from calibration.statistics.regression import block_covariance

SIGNIFICANT = 5.0  # standard errors
MATTERS = 0.02  # of the mean square on held-out rows, beside the flexible fit
# of the same, from where on a delay is told of: 16 logs without one had 0.3 % at most (development seeds 1031
# to 1038, 1062, 1063)
TOLD = 0.005
SMALLEST = 0.2  # sample periods: a shorter one is within the hold of the output
# sample periods, and s, that are looked at: a clock is late by rows, a transport by its own time whatever the
# row (serial and USB adapters 1 to 50 ms; ASSUMPTION: twice that)
LONGEST, LONGEST_S = 25.0, 0.1
ROUNDS = 5
STARTS = 41  # delays tried before it is refined; zero is one of them
# periods, standard errors: half a period, and what friction's memory adds to it (0.56 at an error of 0.001 in
# the opened seed 20261210); EMPS' delay is 0.72 periods
HOLD, SLACK = 0.6, 3.0
QUICK = 0.2  # of the usual top speed: slower rows say nothing of a clock
PARTS = 5  # of the log, in each of which the delay must be seen
ALIKE = 0.35  # of the delay: standard deviation over those parts


def effort_delay(s: Scene, lines: Array) -> tuple[Finding | None, str]:
    """The delay of the response's column against the motion, positive when it tells of earlier times; and,
    where one stands clear of its error but changes next to nothing, what would be needed to tell.

    It is looked for beside `lines` (n_fitted, k), loops, asymmetry, weight and friction over the speed; its
    size is then taken beside a friction curve of any smooth shape, where that can be told from it.
    """
    v = s.view
    s = _quick(s)
    p, r = s.problem, v.response
    if p.train.sum() < 20 * p.base.shape[1] or r.divide_by:
        return None, ""
    full = v.columns[r.channel] * r.gain
    known = p.y - s.at(full)  # what constants took off

    def late(delay: float) -> Array:
        return s.at(v.delayed(full, delay)) + known

    # beside the friction over the speed that explains most: along one kind of ramp it looks like a delay
    rival = min((np.hstack([lines, r]) for r in _rivals(s)), key=lambda r: _left(s, p.y, r))
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
        return None, "" if sound else _too_small(r.channel, delay, error, share)
    curve = np.hstack([lines, any_friction_curve(s)])
    finer, spread = _converge(s, late, curve)
    if spread < abs(finer) / SIGNIFICANT and finer * delay > 0:
        error = float(np.hypot(spread, (finer - delay) / 2))  # half of what the friction curve moves it by
        delay = finer
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
    ), ""


def _too_small(channel: str, delay: float, error: float, share: float) -> str:
    """A delay that is there by its own error, and below what the log's other errors let anyone tell."""
    return (
        f"channel_delay of {channel}, {1e3 * delay:.2g} +- {1e3 * error:.1g} ms, was close (it takes"
        f" {100 * max(share, 0.0):.1f} % of the held-out mean square): quicker turns and a quieter effort"
    )


def _quick(s: Scene) -> Scene:
    """The scene without the rows near rest: there friction turns, which looks late or early by itself."""
    v = s.view
    usual = float(np.quantile(np.abs(v.speed[v.ok]), 0.95)) if v.ok.any() else 0.0
    quick = np.abs(v.speed[v.rows]) > QUICK * usual
    return replace(s, problem=replace(s.problem, valid=s.problem.valid & quick))


def is_hold(f: Finding, period_s: float) -> bool:
    """Whether a delay is what a sound sampled loop shows: an effort that is held for a period acts half a
    period after the position it was made from, and half a period before the next one; which of the two its
    row holds is the log writer's choice."""
    p = f.parameters["delay"]
    if p.low is None or p.high is None:
        return False
    error = (p.high - p.low) / 2 / 1.96
    return bool(abs(p.value) < HOLD * period_s + SLACK * error)


def _converge(s: Scene, late: Callable[[float], Array], more: Array | None = None) -> tuple[float, float]:
    """The delay at which nothing of it is left, and its standard error."""
    reach = max(LONGEST * s.view.period_s, LONGEST_S)
    delay, error = _start(s, late, more, reach), np.inf
    for _ in range(ROUNDS):
        step, error = _step(s, late(delay), more)
        delay = float(np.clip(delay + step, -reach, reach))
        if abs(step) < 0.01 * s.view.period_s:
            break
    return delay, error


def _start(s: Scene, late: Callable[[float], Array], more: Array | None, reach: float) -> float:
    """The delay that fits best of STARTS: a step is a tangent, which from far off leads elsewhere."""
    q, _ = np.linalg.qr(_columns(s, more)[s.problem.train])

    def left(delay: float) -> float:
        y = late(delay)[s.problem.train]
        return float(y @ y - np.sum((q.T @ y) ** 2))

    return float(min(np.linspace(-reach, reach, STARTS), key=left))


def _everywhere(s: Scene, y: Array, delay: float, more: Array) -> bool:
    """A clock is late by the same time in every part of the log; `y` is put right by `delay`."""
    p = s.problem
    x = _columns(s, more)
    rows = p.train
    beta = np.linalg.lstsq(x[rows], y[rows], rcond=1e-8)[0]
    rate = _rate(s, x @ beta)
    q, _ = np.linalg.qr(x[rows])
    e = y[rows] - x[rows] @ beta
    d = -rate[rows]
    d = d - q @ (q.T @ d)
    parts = np.array_split(np.arange(len(e)), PARTS)
    weight = np.array([float(d[k] @ d[k]) for k in parts])
    found = delay + np.array([float(d[k] @ e[k]) for k in parts]) / np.maximum(weight, 1e-300)
    telling = weight > 0.1 * weight.mean()  # a part in which nothing moves says nothing
    return bool(np.std(found[telling]) < ALIKE * abs(delay) and (found[telling] * delay > 0).all())


def _columns(s: Scene, more: Array | None = None) -> Array:
    x = np.hstack([s.problem.base, plain(s), *([] if more is None else [more])])
    size = np.linalg.norm(x[s.problem.train], axis=0)
    return np.asarray(x[:, size > 0] / size[size > 0])


def _rate(s: Scene, model: Array) -> Array:
    rate = np.gradient(model) / s.problem.period_s
    rate[1:][np.diff(s.problem.session) != 0] = 0.0
    return np.asarray(rate)


def _step(s: Scene, y: Array, more: Array | None = None) -> tuple[float, float]:
    """Delay that is left in y, and its standard error: the coefficient of the fitted force's rate."""
    p = s.problem
    x = _columns(s, more)
    rows = p.train
    beta = np.linalg.lstsq(x[rows], y[rows], rcond=1e-8)[0]
    full = np.column_stack([x, -_rate(s, x @ beta)])
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
