"""The drive error of a guided mount as a regression: star offsets, a slow drift per section, the rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

from calibration.channels.problem import Problem
from calibration.errors import CalibrationInputError
from calibration.readers.guide import start_seconds
from calibration.readers.run import Array, Run
from calibration.statistics.whitening import Mask

LEAST_PART = 0.25  # of the longest section: shorter ones only add an offset and a drift each
LEAST_FRAMES = 30  # in a section
PER_TURN = 20.0  # cells in a turn of the quickest part: its eighth harmonic is still seen
CELL_S = 3.0  # quick frames are averaged over this: the eighth harmonic of the quickest worm lasts 19 s
DRIFT_TURNS = 2.0  # of the slowest period: what has not come round twice is not known to be periodic
LEAST_DEGREE = 2  # of the drift: refraction and polar alignment change its rate
SLOWEST_S = 663.0  # s, the worm of a 130-tooth wheel: the slowest of those in use
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


@dataclass
class _Rows:
    """Rows of one section on a regular grid, and where they belong."""

    y: Array
    t: Array
    clock: Array
    dither: Array
    run: int
    segment: NDArray[np.int64]
    held: Mask


def guide_problem(
    runs: list[Run], hold_out: list[str], slowest_s: float = SLOWEST_S, quickest_s: float = SLOWEST_S
) -> tuple[Problem, list[str]]:
    """Problem and the names of what is held out: the end of every section, or the sections that are named.

    `slowest_s` is the longest period that is looked for: what takes longer than two of it is drift, a
    nuisance like the star's offset, of the fitted and of the held-out rows on their own. `quickest_s` is the
    shortest period that is declared.
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
    cell = min(CELL_S, quickest_s / PER_TURN)
    period = frame if 2 * frame > cell else cell
    parts, names = _sections(runs, hold_out, period)
    y, t = np.concatenate([r.y for r in parts]), np.concatenate([r.t for r in parts])
    run = np.concatenate([np.full(len(r.y), r.run) for r in parts]).astype(np.int64)
    segment, held = np.concatenate([r.segment for r in parts]), np.concatenate([r.held for r in parts])
    valid = np.isfinite(y)
    base, labels, fresh = _nuisances(t, run, segment, valid & ~held, valid & held, slowest_s, unit)
    dither = np.concatenate([r.dither for r in parts])
    if np.ptp(dither) > 0:
        base = np.column_stack([base, dither - dither.mean()])
        labels.append(("guide_gain_error", "1"))
    whole = bool(hold_out) and all(start_seconds(r) is not None for r in runs)
    problem = Problem(
        "K",
        unit,
        np.where(valid, y, 0.0),
        base,
        labels,
        t,
        run,
        np.zeros_like(run) if whole else run,
        valid,
        held,
        period,
        ar_order=3,
        block_s=max(12 * period, 40.0),
        sensor="position",
        fresh=fresh,
        domains={"clock": np.concatenate([r.clock for r in parts])} if whole else {},
    )
    bent = np.diff(y, 2)  # of neighbouring cells: a worm moves from cell to cell, and hardly bends
    bent = bent[np.isfinite(bent)]
    if len(bent):
        problem.floor = float(np.median(np.abs(bent - np.median(bent))) * 1.4826 / np.sqrt(6))
    return problem, names


def _sections(runs: list[Run], hold_out: list[str], period: float) -> tuple[list[_Rows], list[str]]:
    """Every section on its grid, one after another in time, and the names of what is held out."""
    parts: list[_Rows] = []
    names: list[str] = []
    count, offset = 0, 0.0
    for k, r in enumerate(runs):
        grid = np.arange(r.columns["t"][0], r.columns["t"][-1] + 1e-9, period)
        t = grid - grid[0] + offset
        start = start_seconds(r)
        near = np.clip(np.searchsorted(r.columns["t"], grid), 1, r.rows - 1)
        segment = r.columns["segment"][near].astype(np.int64) + count
        count = int(segment.max()) + 1
        held = np.full(len(grid), named(r, hold_out))
        if not hold_out:
            held[int((1 - HELD_PART) * len(grid)) :] = True
            names.append(f"{r.name} from {(1 - HELD_PART) * (grid[-1] - grid[0]):.0f} s")
        elif held.all():
            names.append(r.name)
        clock = t if start is None else grid + start
        dither = r.columns["dither"][near] if "dither" in r.columns else np.zeros(len(grid))
        parts.append(_Rows(_on_grid(r, grid, period), t, clock, dither, k, segment, held))
        offset = t[-1] + 20 * period
    return parts, names


def _nuisances(
    t: Array,
    run: NDArray[np.int64],
    segment: NDArray[np.int64],
    train: Mask,
    test: Mask,
    slowest_s: float,
    unit: str,
) -> tuple[Array, list[tuple[str, str]], Array]:
    """Offsets per segment and drift per section: of the fitted rows with labels, and of the held-out rows."""
    sides: list[list[Array]] = [[], []]
    labels: list[tuple[str, str]] = []
    for side, rows in enumerate((train, test)):
        for s in np.unique(segment[rows]):
            sides[side].append(((segment == s) & rows).astype(float))
            labels += [("offset", unit)] * (side == 0)
        for k in np.unique(run[rows]):
            here = (run == k) & rows
            drift = _drift(t, here, slowest_s)
            sides[side] += list(drift.T)
            labels += [("drift", unit)] * (drift.shape[1] * (side == 0))
    empty = np.zeros((len(t), 0))
    base, fresh = (np.column_stack(side) if side else empty for side in sides)
    return base, labels, fresh


def _drift(t: Array, here: Mask, slowest_s: float) -> Array:
    """Legendre polynomials over the rows `here`, zero elsewhere: refraction and the polar axis' error bend
    the drift, flexure bends it further; a polynomial of degree d follows d / 2 waves."""
    span = float(np.ptp(t[here]))
    degree = max(round(span / (DRIFT_TURNS * slowest_s / 2)), LEAST_DEGREE)
    x = np.where(here, 2 * (t - t[here].min()) / max(span, 1e-9) - 1, 0.0)
    return np.where(here[:, None], legvander(x, degree)[:, 1:], 0.0)


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
