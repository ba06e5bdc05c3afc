"""The regression of a drive's response: a balance of forces, or one sensor against another."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from calibration.channels.frictionlaw import friction_shape
from calibration.channels.problem import Problem
from calibration.channels.slowoffset import with_slow_offset
from calibration.channels.view import View
from calibration.inputs.record import Record
from calibration.readers.run import Array
from calibration.statistics.whitening import Mask

LOADED = 0.5  # of the median divisor: below, the ratio says nothing
STANDS = 0.2  # of a row's filter, that may lie where the drive stands
BLOCKS = 60  # of the logged time, for the block-robust covariance
COVER = 0.02  # of its own quantile range that a held-out file may exceed the others


def problem_of(view: View, records: list[Record], hold_out: list[str], delay_s: float = 0.0) -> Problem:
    """The response and its declared terms on the fitted rows; the response's column is late by `delay_s`."""
    rig, response = view.rig, view.response
    y, ok = response_of(view, delay_s)
    labels, base = _base(view)
    for name, value in rig.constants.items():
        y = y - value * _term(view, name)[:, 0]
    at = view.rows
    valid = (view.ok & ok)[at]
    if view.dynamic and response.channel != "acceleration":
        valid &= view.at((np.abs(view.speed) < view.slow).astype(float)) < STANDS
    if not view.dynamic and response.is_force:
        valid &= np.abs(view.direction[at]) > 0
    session = view.file[at]
    run = view.run[at]
    held = _held(view, records, session, run, hold_out, rig.hold_out)
    held, valid = _apart(held, valid, view)
    period = view.period_s * view.step
    problem = Problem(
        "T" if response.is_force else "K",
        response.unit,
        view.at(y),
        view.at(base),
        labels,
        view.clock[at],
        run,
        session,
        valid,
        held,
        period,
        ar_order=0,
        block_s=max(20 * period, len(at) * period / BLOCKS),
        sensor="torque" if response.is_force else "position",
    )
    if not response.is_force:  # an incremental sensor starts anywhere: every file has its own offset
        problem.fresh = np.column_stack([(session == k).astype(float) for k in np.unique(session)])
    return with_slow_offset(problem, view, view.slow_offset)


def response_of(view: View, delay_s: float) -> tuple[Array, Mask]:
    """The response (n,) at full rate, its column late by `delay_s`, and the rows where it says anything."""
    r, ok = view.response, np.ones(len(view.t), dtype=bool)
    if r.channel == "acceleration":
        x = view.columns.get("acceleration")
        y = view.second(view.x) if x is None else x
    else:
        y = view.delayed(view.columns[r.channel], delay_s)
    y = y * r.gain
    if r.ratio:
        y = y - r.ratio * view.x
    if r.divide_by:
        below = view.columns[r.divide_by]
        if r.divide_by == "supply":
            y = y * (float(np.mean(below)) / np.where(below != 0, below, np.inf))
        else:
            ok = np.abs(below) > LOADED * np.median(np.abs(below))
            y = y / np.where(ok, below, np.inf)
    return y, ok


def default_terms(view: View) -> tuple[str, ...]:
    """The declared model's terms: those of the rig file, and what every response of its kind needs."""
    if view.response.is_force:
        return view.rig.estimate or ("viscous", "coulomb", "offset")
    drift = ("drift",) if "drift" in view.rig.estimate else ()
    scale = ("scale",) if view.response.channel == "position2" and view.response.ratio is None else ()
    return ("offset", *scale, *drift)


def _base(view: View) -> tuple[list[tuple[str, str]], Array]:
    unit, x = view.unit, view.angle_unit
    names = default_terms(view)
    units = {
        "inertia": f"{unit} s2/{x}",
        "viscous": f"{unit} s/{x}",
        "coulomb": unit,
        "offset": unit,
        "drift": f"{unit}/s",
        "stiffness": f"{unit}/{x}",
        "scale": f"{unit}/{x}",
        "gravity_cos": unit,
        "gravity_sin": unit,
    }
    labels: list[tuple[str, str]] = []
    parts = []
    for name in names:
        if name == "offset" and not view.response.is_force and len(np.unique(view.file)) > 1:
            for k in np.unique(view.file):
                parts.append((view.file == k).astype(float)[:, None])
                labels.append((f"offset_{int(k) + 1}", unit))
            continue
        parts.append(_term(view, name))
        labels += [(n, units[n]) for n in (("gravity_cos", "gravity_sin") if name == "gravity" else (name,))]
    return labels, np.hstack(parts)


def _term(view: View, name: str) -> Array:
    """Full-rate columns (n, k) of a term of the declared model."""
    if name == "gravity":
        from math import pi

        angle = view.x / (view.turn or 1.0) * 2 * pi
        return np.column_stack([np.cos(angle), np.sin(angle)])
    free = view.response.channel == "acceleration"  # what brakes is negative there
    columns: dict[str, Callable[[], Array]] = {
        "inertia": lambda: view.columns.get("acceleration", view.second(view.x)),
        "viscous": lambda: view.rate(view.x) * (-1.0 if free else 1.0),
        "coulomb": lambda: friction_shape(view) * (-1.0 if free else 1.0),
        "offset": lambda: np.ones(len(view.t)),
        "drift": lambda: view.clock - view.clock.mean(),
        "stiffness": lambda: view.x - view.x.mean(),
        "scale": lambda: view.x - view.x.mean(),
    }
    return np.asarray(columns[name]())[:, None]


def _held(
    view: View,
    records: list[Record],
    session: NDArray[np.int64],
    run: NDArray[np.int64],
    names: list[str],
    fraction: float,
) -> Mask:
    """The named files; of three and more the one whose motion the others cover; else the end of every
    run."""
    held = np.zeros(len(run), dtype=bool)
    if names:
        for k, r in enumerate(records):
            held[session == k] = bool({r.name, str(r.path), r.path.name, r.path.stem} & set(names))
        return held
    if len(records) >= 3:
        return np.asarray(session == _covered(view, session, len(records)))
    for label in np.unique(run):
        rows = np.flatnonzero(run == label)
        held[rows[int(len(rows) * (1 - fraction)) :]] = True
    return held


def _covered(view: View, session: NDArray[np.int64], count: int) -> int:
    """The file that leaves the ranges of the others least; of those the middle one in time."""
    x, v = view.x[view.rows], np.abs(view.speed[view.rows])
    excess = np.zeros(count)
    for k in range(count):
        mine = session == k
        for z in (x, v):
            low, high = np.quantile(z[~mine], [0.01, 0.99])
            a, b = np.quantile(z[mine], [0.02, 0.98])
            excess[k] += (max(low - a, 0.0) + max(b - high, 0.0)) / max(high - low, 1e-300)
    good = np.flatnonzero(excess <= excess.min() + COVER)
    clock = np.array([view.clock[view.rows][session == k].mean() for k in good])
    return int(good[np.argsort(clock)[len(good) // 2]])


def _apart(held: Mask, valid: Mask, view: View) -> tuple[Mask, Mask]:
    """Rows whose filter reaches over the border between fitted and held-out rows belong to neither."""
    reach = int(np.ceil(3 * view.sigma / max(view.step, 1)))
    if reach == 0:
        return held, valid
    border = np.flatnonzero(np.diff(held.astype(int)) != 0)
    out = valid.copy()
    for k in border:
        out[max(k - reach // 2, 0) : k + 1 + reach // 2] = False
    return held, out
