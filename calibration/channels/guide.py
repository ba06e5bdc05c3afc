"""The drive error of a guided mount as a regression: an offset per segment, a drift per section, the rest."""

from __future__ import annotations

import numpy as np

from calibration.channels.problem import Problem
from calibration.errors import CalibrationInputError
from calibration.readers.guide import start_seconds
from calibration.readers.run import Array, Run

LEAST_PART = 0.25  # of the longest section: shorter ones only add an offset and a drift each
LEAST_FRAMES = 30  # in a section
CELL_S = 3.0  # quick frames are averaged over this: the eighth harmonic of the quickest worm lasts 19 s
HELD_PART = 0.4  # of every section, at its end, unless runs are named


def usable(runs: list[Run], hold_out: list[str]) -> tuple[list[Run], list[str]]:
    """The sections long enough to say something beside the longest, and a note on those left out."""
    longest = max(r.duration_s for r in runs)
    keep = [
        r
        for r in runs
        if named(r, hold_out) or (r.rows >= LEAST_FRAMES and r.duration_s >= LEAST_PART * longest)
    ]
    keep = [r for r in keep if r.rows >= 3]
    lost = len(runs) - len(keep)
    if not lost:
        return keep, []
    return keep, [
        f"{lost} of {len(runs)} sections left out: shorter than {LEAST_FRAMES} frames or than a quarter"
        f" of the longest ({longest:.0f} s)"
    ]


def named(run: Run, hold_out: list[str]) -> bool:
    """Whether --hold-out names this section or its file."""
    return bool({run.name, run.path.name, str(run.path)} & set(hold_out))


def guide_problem(runs: list[Run], hold_out: list[str]) -> tuple[Problem, list[str]]:
    """Problem and the names of what is held out: the end of every section, or the sections that are named.

    `session` is where a period keeps its phase: a section, because a slew between two turns the worm; when
    whole sections are held out, all of them on the clock (`domains["clock"]`), for nothing else could be
    predicted there.
    """
    units = {r.header.get("unit", "arcsec") for r in runs}
    if len(units) > 1:
        raise CalibrationInputError(
            runs[0].path, "logs with and without a pixel scale cannot be put together"
        )
    unit = next(iter(units))
    frame = float(np.median(np.concatenate([np.diff(r.columns["t"]) for r in runs])))
    period = frame if 2 * frame > CELL_S else CELL_S
    starts = [start_seconds(r) for r in runs]
    y, t, clock, run, segment, held, names = [], [], [], [], [], [], []
    count, offset = 0, 0.0
    for k, r in enumerate(runs):
        grid = np.arange(r.columns["t"][0], r.columns["t"][-1] + 1e-9, period)
        y.append(_on_grid(r, grid, period))
        t.append(grid - grid[0] + offset)
        start = starts[k]
        clock.append(t[-1] if start is None else grid + start)
        near = np.clip(np.searchsorted(r.columns["t"], grid), 1, r.rows - 1)
        part = r.columns["segment"][near].astype(int)
        segment.append(part + count)
        count += int(part.max()) + 1
        run.append(np.full(len(grid), k))
        test = np.full(len(grid), named(r, hold_out))
        if not hold_out:
            test[int((1 - HELD_PART) * len(grid)) :] = True
            names.append(f"{r.name} from {(1 - HELD_PART) * (grid[-1] - grid[0]):.0f} s")
        elif test.all():
            names.append(r.name)
        held.append(test)
        offset = t[-1][-1] + 20 * period
    yy, tt, rr = np.concatenate(y), np.concatenate(t), np.concatenate(run).astype(np.int64)
    ss, hh = np.concatenate(segment), np.concatenate(held)
    columns, labels, fresh = [], [], []
    for s in np.unique(ss):
        columns.append((ss == s).astype(float))
        labels.append(("offset", unit))
        fresh.append(columns[-1])
    for k in range(len(runs)):
        m = rr == k
        columns.append(np.where(m, tt - tt[m].mean(), 0.0))
        labels.append(("drift", f"{unit}/s"))
        if (m & hh).sum() == m.sum():
            fresh.append(columns[-1])
    valid = np.isfinite(yy)
    whole = bool(hold_out) and all(s is not None for s in starts)
    problem = Problem(
        "K",
        unit,
        np.where(valid, yy, 0.0),
        np.column_stack(columns),
        labels,
        tt,
        rr,
        np.zeros_like(rr) if whole else rr,
        valid,
        hh,
        period,
        ar_order=3,
        block_s=max(12 * period, 40.0),
        sensor="position",
        fresh=np.column_stack(fresh),
        domains={"clock": np.concatenate(clock)} if whole else {},
    )
    steps = np.diff(yy)
    steps = steps[np.isfinite(steps)]
    if len(steps):
        problem.floor = float(np.median(np.abs(steps - np.median(steps))) * 1.4826 / np.sqrt(2))
    return problem, names


def _on_grid(run: Run, grid: Array, period: float) -> Array:
    """Drive error on a regular grid; NaN where no frame is near."""
    at = run.columns["t"]
    near = np.clip(np.searchsorted(at, grid), 1, run.rows - 1)
    apart = np.minimum(np.abs(at[near] - grid), np.abs(at[near - 1] - grid))
    if period > 1.5 * float(np.median(np.diff(at))):
        cell = np.minimum(np.round((at - grid[0]) / period).astype(np.int64), len(grid) - 1)
        count = np.bincount(cell, minlength=len(grid))
        mean = np.bincount(cell, run.columns["ra"], len(grid)) / np.maximum(count, 1)
        return np.where(count > 0, mean, np.nan)
    return np.where(apart < 1.5 * period, np.interp(grid, at, run.columns["ra"]), np.nan)
