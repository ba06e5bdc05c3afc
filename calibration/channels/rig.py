"""The residual of another drive: response = inertia a + viscous v + coulomb sign(v) + offset, and what is
left."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.candidates.context import Context, direction_of, since_reversal, turning_points
from calibration.channels.problem import Problem
from calibration.channels.rates import local_polynomial, regular
from calibration.errors import CalibrationInputError
from calibration.readers.rig import Rig
from calibration.readers.run import Array, Run

STANDSTILL = 0.005  # of the usual top speed: slower is standing
LONGEST = 0.02  # of a run: a longer window or step would leave too little of it
MIN_ROWS = 200  # fewer rows than this say nothing about ten parameters


def rig_problem(runs: list[Run], rig: Rig, hold_out: list[str]) -> tuple[Problem, Context]:
    """Build the regression of a rig's response; raises CalibrationInputError when a needed channel is
    missing."""
    parts = [_one(r, rig, k) for k, r in enumerate(runs)]
    join = {k: np.concatenate([p[k] for p in parts]) for k in parts[0]}
    files = np.concatenate([np.full(len(p["t"]), k) for k, p in enumerate(parts)]).astype(np.int64)
    period = float(np.median(np.diff(parts[0]["t"])))
    direction = direction_of(join["x"], files, least_travel(join["x"]))
    moving = direction != 0
    if "inertia" in rig.estimate:  # a driven axis also stands still: there its friction has no direction
        direction = np.tanh(join["v"] / (STANDSTILL * float(np.quantile(np.abs(join["v"]), 0.95)) or 1.0))
    run = _runs(rig, join, files)
    held = _held(runs, rig, files, run, hold_out)
    base, labels = _base(rig, join, direction)
    problem = Problem(
        "T",
        rig.response["unit"],
        join["y"],
        base,
        labels,
        join["t"],
        run,
        files,
        np.isfinite(join["y"]) & moving & (join["ok"] > 0),
        held,
        period,
        ar_order=0,
        block_s=max(20 * period, float(np.ptp(join["t"])) / 60),
        sensor="torque",
    )
    stages = {s.name: 1 / s.period for s in rig.stages if s.period}
    unit = rig.columns["position"].unit
    context = Context(
        join["t"],
        join["x"],
        join["v"],
        direction,
        since_reversal(join["x"], direction, files),
        run,
        files,
        rig.response["unit"],
        unit,
        1.0,
        np.ones(len(run)),
        temperature=join.get("temperature"),
        stages=stages,
    )
    problem.floor = repeatability(problem, context)
    return problem, context


def least_travel(x: Array) -> float:
    """Travel that counts as motion: above the position's noise, and a ten-thousandth of the range at
    least."""
    reach = float(np.quantile(x, 0.99) - np.quantile(x, 0.01))
    second = x[2:] - 2 * x[1:-1] + x[:-2]
    return max(1e-4 * reach, 12 * float(np.median(np.abs(second))))


def _one(run: Run, rig: Rig, index: int) -> dict[str, Array]:
    channel = rig.response["channel"]
    if "position" not in run.columns:
        raise CalibrationInputError(rig.path, "columns: 'position' is needed")
    if run.rows < MIN_ROWS:
        raise CalibrationInputError(
            run.path, f"{run.rows} rows are too few to say anything (at least {MIN_ROWS})"
        )
    t = run.columns["t"]
    period = float(np.median(np.diff(t)))
    grid, c = regular(t, {k: v for k, v in run.columns.items() if k != "t"}, period)
    nearest = np.minimum(np.searchsorted(t, grid), len(t) - 1)
    ok = np.minimum(np.abs(t[nearest] - grid), np.abs(t[np.maximum(nearest - 1, 0)] - grid)) < 1.5 * period
    y = c[channel] * rig.response.get("gain", 1.0)
    if "divide_by" in rig.response:
        below = c[rig.response["divide_by"]]
        ok &= np.abs(below) > 0.5 * np.median(np.abs(below))  # unloaded: the ratio says nothing
        y = y / np.where(ok, below, np.inf)
    for field, value in (("smooth_s", rig.smooth_s), ("analyse_period_s", rig.analyse_period_s)):
        if value is not None and value > LONGEST * run.duration_s:
            raise CalibrationInputError(
                rig.path, f"{field}: {value:g} s is too long for a run of {run.duration_s:.4g} s"
            )
    window = round((rig.smooth_s or 21 * period) / period) | 1
    out = {
        "t": grid,
        "x": local_polynomial(c["position"], window, 0, period),
        "v": local_polynomial(c["position"], window, 1, period),
        "a": local_polynomial(c["position"], window, 2, period),
    }
    out["y"] = local_polynomial(y, window, 0, period) if "inertia" in rig.estimate else y
    out["ok"] = ok.astype(float)
    if "temperature" in c:
        out["temperature"] = c["temperature"]
    step = max(round((rig.analyse_period_s or period) / period), 1)
    return {k: v[::step] for k, v in out.items()}


def _runs(rig: Rig, join: dict[str, Array], files: NDArray[np.int64]) -> NDArray[np.int64]:
    if rig.runs.get("by") != "turning_points":
        return files
    least = float(rig.runs.get("minimum_travel", 0.0))
    return np.asarray(np.cumsum(turning_points(join["x"], files, least)), dtype=np.int64)


def _held(
    runs: list[Run], rig: Rig, files: NDArray[np.int64], run: NDArray[np.int64], names: list[str]
) -> NDArray[np.bool_]:
    held = np.zeros(len(run), dtype=bool)
    if names:
        for k, r in enumerate(runs):
            held[files == k] = r.name in names or str(r.path) in names or r.path.name in names
        return held
    if len(runs) >= 3:
        return np.asarray(files == len(runs) - 1)
    for label in np.unique(run):
        rows = np.flatnonzero(run == label)
        held[rows[int(len(rows) * (1 - rig.hold_out)) :]] = True
    return held


def _base(rig: Rig, c: dict[str, Array], direction: Array) -> tuple[Array, list[tuple[str, str]]]:
    unit, x = rig.response["unit"], rig.columns["position"].unit
    table = {
        "inertia": (c["a"], f"{unit} s2/{x}"),
        "viscous": (c["v"], f"{unit} s/{x}"),
        "coulomb": (direction, unit),
        "offset": (np.ones_like(direction), unit),
        "drift": (c["t"] - c["t"].mean(), f"{unit}/s"),
        "stiffness": (c["x"] - c["x"].mean(), f"{unit}/{x}"),
    }
    return (
        np.column_stack([table[name][0] for name in rig.estimate]),
        [(name, table[name][1]) for name in rig.estimate],
    )


def repeatability(problem: Problem, c: Context, bins: int = 200) -> float:
    """What repeats of the same place, direction and speed leave: the pooled scatter within fine bins."""
    period = 1 / max(c.stages.values()) if c.stages else 0.0
    span = float(np.ptp(c.angle)) or 1.0
    place = np.floor(((c.angle % period) / period if period else (c.angle - c.angle.min()) / span) * bins)
    speed = np.floor(np.argsort(np.argsort(c.speed)) / len(c.speed) * 12)
    level = np.floor(c.since / span * 20) if not period else 0 * place
    key = ((place * 3 + c.direction + 1) * 50 + (speed if not period else 0)) * 100 + level
    rows = problem.valid
    _, label, count = np.unique(key[rows], return_inverse=True, return_counts=True)
    y = problem.y[rows]
    beta = np.linalg.lstsq(problem.base[rows], y, rcond=None)[0]
    e = y - problem.base[rows] @ beta
    mean = np.bincount(label, e) / count
    many = count[label] >= 3
    if many.sum() < 50:
        return 0.0
    scatter = (e - mean[label]) ** 2 * count[label] / np.maximum(count[label] - 1, 1)
    return float(np.sqrt(np.mean(scatter[many])))
