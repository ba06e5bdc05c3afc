"""The drive error of a guided mount as a regression: star offsets, a slow drift per section, the rest."""

from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

from calibration.arrays import Array, Mask, by_median
from calibration.balances.problem import Problem
from calibration.balances.thresholds import FEWEST_FOR_A_DRIFT
from calibration.errors import CalibrationInputError
from calibration.inputs.run import Run
from calibration.statistics.tails import rms

LEAST_PART = 0.25  # of the longest section: shorter ones only add an offset and a drift each. ASSUMPTION
LEAST_FRAMES = 30  # in a section. ASSUMPTION
PER_TURN = 20.0  # cells in a turn of the quickest part: its eighth harmonic is still seen. ASSUMPTION
# quick frames are averaged over this: the eighth harmonic of the quickest worm lasts 19 s. ASSUMPTION
CELL_S = 3.0
# of the slowest period: what has not come round twice is not known to be periodic. ASSUMPTION
DRIFT_TURNS = 2.0
LEAST_DEGREE = 2  # of the drift: refraction and polar alignment change its rate. ASSUMPTION
MOST_DEGREE = 43  # likewise at most: eight hours of a mount's slowest worm. ASSUMPTION
# s, the worm of a 130-tooth wheel: the slowest of those in use. arithmetic, the sidereal day over its teeth
SLOWEST_S = 663.0
# blocks in a turn of the slowest period, 40 s of a mount's: air and guiding forget sooner. ASSUMPTION
PER_BLOCK = 16.6
# parts of the quickest turn: over two of them a parabola follows a sine within some hundredths. arithmetic
QUARTER = 4.0
# robust deviations, at which a frame beside its neighbours is cut off: air of heavy tails stays. ASSUMPTION
CUT = 5.0
# pieces of the longest section, each held out in its turn, where it has fewer turns. ASSUMPTION
LEAST_PIECES = 3
EVERY = 6  # groups of pieces, where there are more: every sixth piece is held out together. ASSUMPTION


def usable(runs: list[Run], hold_out: list[str]) -> tuple[list[Run], list[str]]:
    """The sections long enough to say something beside the longest, and a note on those left out."""
    longest = max(r.duration_s for r in runs)
    keep = [
        r
        for r in runs
        if r.rows >= (FEWEST_FOR_A_DRIFT if r.among(hold_out) else LEAST_FRAMES)
        and (r.among(hold_out) or r.duration_s >= LEAST_PART * longest)
    ]
    note = (
        f"{len(runs) - len(keep)} of {len(runs)} sections left out: shorter than {LEAST_FRAMES} frames or"
        f" than a quarter of the longest ({longest:.0f} s)"
    )
    return keep, [note] if len(keep) < len(runs) else []


def guide_problem(
    runs: list[Run],
    hold_out: list[str],
    slowest_s: float = SLOWEST_S,
    quickest_s: float = SLOWEST_S,
) -> tuple[Problem, list[str]]:
    """Problem and the names of sections that are held out; where none is named, pieces are, in turn.

    `slowest_s`: longest period looked for; what takes twice as long is drift, a nuisance that sections held
    out have on their own. `quickest_s`: shortest declared period. With the clock as a domain a period keeps
    its phase from section to section; else a slew turns the worm.
    """
    unit = _unit(runs)
    frame = float(np.median(np.concatenate([np.diff(r.columns["t"]) for r in runs])))
    cell = min(CELL_S, quickest_s / PER_TURN)
    period = frame if 2 * frame > cell else cell
    sections, names = _sections(runs, hold_out, period)
    rows = {name: np.concatenate([r[name] for r in sections]) for name in sections[0]}
    y, run, dither = rows["y"], rows["run"], rows["dither"]
    valid = np.isfinite(y)
    held, part, fresh = rows["held"], run, None
    if hold_out:
        fresh = _nuisances(rows, valid & held, slowest_s)[0]
    else:
        part = _pieces(rows["t"], run, slowest_s)
        held = part == 0
    base, offsets, drifts = _nuisances(rows, valid & ~rows["held"], slowest_s)
    labels = [("offset", unit)] * offsets + [("drift", unit)] * drifts
    if np.ptp(dither) > 0:
        base = np.column_stack([base, dither - dither.mean()])
        labels.append(("guide_gain_error", "1"))
    whole = bool(hold_out) and all(r.start_s is not None for r in runs)
    block_s = max(12 * period, slowest_s / PER_BLOCK)
    problem = Problem(
        channel="K",
        unit=unit,
        y=np.where(valid, y, 0.0),
        base=base,
        base_labels=labels,
        t=rows["t"],
        run=run,
        session=part,
        valid=valid,
        held=held,
        turned=None if hold_out else valid,
        slow=not hold_out,
        period_s=period,
        ar_order=3,
        block_s=block_s,
        fresh=fresh,
        domains={"clock": rows["clock"]} if whole else {},
        floor=_air(y, rows["segment"], max(round(min(block_s, quickest_s / QUARTER) / period), 3)),
    )
    return problem, names


def _air(y: Array, segment: NDArray[np.int64], side: int) -> float:
    """rms of air and centroid: each cell beside a parabola through `side` cells before and behind.

    A worm follows it, and air forgets. What the parabola takes along of the noise is given back, as if that
    were white. Cells without frames, or of another segment, do not count. A jump is cut off: it is no air.
    """
    if len(y) <= 2 * side:
        return 0.0
    at = np.arange(-side, side + 1) / side
    shape = np.column_stack([np.ones_like(at), at, at**2])
    near, own = sliding_window_view(y, 2 * side + 1), sliding_window_view(segment, 2 * side + 1)
    seen = np.isfinite(near) & (own == own[:, side : side + 1])
    good = (
        seen[:, side]
        & (seen[:, :side].sum(axis=1) > side // 2)
        & (seen[:, side + 1 :].sum(axis=1) > side // 2)
    )
    if not good.any():
        return 0.0
    seen, near = seen[good].astype(float), np.where(seen[good], near[good], 0.0)
    products = (seen @ (shape[:, :, None] * shape[:, None, :]).reshape(len(at), 9)).reshape(-1, 3, 3)
    inverse = np.linalg.inv(products)
    fitted = (inverse[:, 0] * (near @ shape)).sum(axis=1)
    left = (near[:, side] - fitted) / np.sqrt(np.maximum(1.0 - inverse[:, 0, 0], 1e-9))
    usual = by_median(left)
    return rms(np.clip(left, -CUT * usual, CUT * usual))


def _unit(runs: list[Run]) -> str:
    units = {r.header.get("unit", "arcsec") for r in runs}
    if len(units) > 1:
        raise CalibrationInputError(
            runs[0].path, "logs with and without a pixel scale cannot be put together"
        )
    return next(iter(units))


def _sections(runs: list[Run], hold_out: list[str], period: float) -> tuple[list[dict[str, Any]], list[str]]:
    """Columns of every section on its grid, one after another in time, and the names of what is held out."""
    parts: list[dict[str, Any]] = []
    names: list[str] = []
    count, offset = 0, 0.0
    for k, r in enumerate(runs):
        grid = np.arange(r.columns["t"][0], r.columns["t"][-1] + 1e-9, period)
        t = grid - grid[0] + offset
        near = np.clip(np.searchsorted(r.columns["t"], grid), 1, r.rows - 1)
        segment = r.columns["segment"][near].astype(np.int64) + count
        held = np.full(len(grid), r.among(hold_out))
        if held.all():
            names.append(r.name)
        parts.append(
            {
                "y": _on_grid(r, grid, period),
                "t": t,
                "clock": t if r.start_s is None else grid + r.start_s,
                "dither": r.columns["dither"][near] if "dither" in r.columns else np.zeros(len(grid)),
                "run": np.full(len(grid), k, dtype=np.int64),
                "segment": segment,
                "held": held,
            }
        )
        count, offset = int(segment.max()) + 1, t[-1] + 20 * period
    return parts, names


def _nuisances(columns: dict[str, Array], rows: Mask, slowest_s: float) -> tuple[Array, int, int]:
    """Offsets per segment and drift per section of `rows`, (n, k), and how many there are of each."""
    segment, run = columns["segment"], columns["run"]
    offsets = [((segment == s) & rows).astype(float) for s in np.unique(segment[rows])]
    drifts = [x for k in np.unique(run[rows]) for x in _drift(columns["t"], (run == k) & rows, slowest_s).T]
    both = [*offsets, *drifts]
    return np.column_stack(both) if both else np.zeros((len(rows), 0)), len(offsets), len(drifts)


def piece_s(p: Problem) -> float:
    """Usual length of a piece that is held out in its turn, s."""
    ends = np.flatnonzero(np.diff(p.session, append=-1))
    return float(np.median(np.diff(ends, prepend=-1))) * p.period_s


def _pieces(t: Array, run: NDArray[np.int64], slowest_s: float) -> NDArray[np.int64]:
    """Which turn every row is held out in.

    A piece lasts a turn of the slowest period: air that moves slowly goes on into a shorter one beside it.
    """
    spans = [float(np.ptp(t[run == k])) for k in np.unique(run)]
    length = min(slowest_s, max(spans) / LEAST_PIECES)
    out, first = np.zeros(len(t), dtype=np.int64), 0
    for k, span in zip(np.unique(run), spans, strict=True):
        here, count = run == k, max(round(span / length), 2)  # the other one tells a section's own phase
        out[here] = first + np.floor((t[here] - t[here].min()) / (span + 1e-9) * count).astype(np.int64)
        first += count
    return out % EVERY


def _drift(t: Array, here: Mask, slowest_s: float) -> Array:
    """Legendre polynomials over the rows `here`: refraction, polar axis and flexure; degree d has d / 2
    waves."""
    span = float(np.ptp(t[here]))
    degree = min(max(round(span / (DRIFT_TURNS * slowest_s / 2)), LEAST_DEGREE), MOST_DEGREE)
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
