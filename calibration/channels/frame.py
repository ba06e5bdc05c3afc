"""Axis logs on one regular grid: gaps are NaN rows, runs follow each other, every column in SI units."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from calibration.inputs.declaration import Rig
from calibration.inputs.telescope import telescope
from calibration.inputs.train import Train, train_of
from calibration.readers.run import Array, Run
from calibration.statistics.whitening import Mask

COLUMNS = (
    "effort",
    "position",
    "velocity",
    "current_a",
    "current_b",
    "motor_a",
    "motor_b",
    "aux",
    "setpoint",
    "supply",
    "temperature",
    "unseen",  # 1 where the position is not measured but carried on from the motors; no log has it
)


@dataclass
class Frame:
    """Columns (n,) at the log's sample period; `run`, `session` integer labels; `clock` the stamps as
    logged."""

    runs: list[Run]
    period_s: float
    t: Array  # s since the first row of the first run, nominal grid; runs are kept apart by their start times
    clock: Array  # logged stamp minus nominal grid, s; NaN where the row is missing
    run: NDArray[np.int64]
    session: NDArray[np.int64]
    columns: dict[str, Array]
    scale: dict[str, float]
    rig: Rig  # the drive's declaration
    missing: dict[str, list[tuple[float, int]]] = field(
        default_factory=dict
    )  # run -> (time, rows) of every gap

    @property
    def train(self) -> Train:
        """The declared gear train."""
        return train_of(self.rig)

    @property
    def present(self) -> Mask:
        """Rows that are in the log."""
        return np.isfinite(self.clock)

    def get(self, name: str) -> Array | None:
        """A column, or None when no run has it."""
        x = self.columns.get(name)
        return x if x is not None and np.isfinite(x).mean() > 0.05 else None


def build_frame(runs: list[Run], rig: Rig | None = None) -> Frame:
    """Put all runs of one axis on one grid. Rows between samples are NaN; stamps are rounded to the grid.
    `rig` declares the drive: the telescope's own axis without it."""
    period = runs[0].scales["sample_period_s"]
    sessions = {s: k for k, s in enumerate(dict.fromkeys(r.session for r in runs))}
    parts: dict[str, list[Array]] = {c: [] for c in (*COLUMNS, "t", "clock")}
    labels, owners = [], []
    missing: dict[str, list[tuple[float, int]]] = {}
    offset = 0.0
    for index, r in enumerate(runs):
        t = r.columns["t"]
        place = _places(t, period)
        n = int(place[-1]) + 1
        grid = t[0] + period * np.arange(n)
        clock = np.full(n, np.nan)
        clock[place] = t - grid[place]
        for name in COLUMNS:
            column = np.full(n, np.nan)
            if name in r.columns:
                column[place] = r.columns[name]
            parts[name].append(column)
        gaps = np.flatnonzero(np.diff(place) > 1)
        missing[r.name] = [(float(t[g]), int(place[g + 1] - place[g] - 1)) for g in gaps]
        parts["t"].append(grid - grid[0] + offset)
        parts["clock"].append(clock)
        offset = parts["t"][-1][-1] + 10 * period
        labels.append(np.full(n, index))
        owners.append(np.full(n, sessions[r.session]))
    joined = {k: np.concatenate(v) for k, v in parts.items()}
    return Frame(
        runs,
        period,
        joined.pop("t"),
        joined.pop("clock"),
        np.concatenate(labels).astype(np.int64),
        np.concatenate(owners).astype(np.int64),
        joined,
        dict(runs[0].scales),
        rig or telescope(runs[0].header["axis"]),
        missing,
    )


def _places(t: Array, period: float) -> NDArray[np.int64]:
    """Grid index of every row: strictly rising, one step per row unless stamps show a gap."""
    step = np.maximum(np.round(np.diff(t) / period), 1).astype(np.int64)
    # a drifting or jittering stamp must not open a gap: count gaps only where the stamp jumps by 1.6 periods
    step[np.diff(t) < 1.6 * period] = 1
    return np.concatenate([[0], np.cumsum(step)]).astype(np.int64)


def fill(x: Array, run: NDArray[np.int64], longest: int = 3) -> tuple[Array, Mask]:
    """Linear interpolation over gaps; returns the filled column and where it may be trusted (short gaps
    only)."""
    good = np.isfinite(x)
    if not good.any():
        return np.zeros_like(x), good
    index = np.arange(len(x))
    out = np.interp(index, index[good], x[good])
    left = np.where(good, index, -1)
    np.maximum.accumulate(left, out=left)
    right = np.where(good, index, len(x) + longest + 2)
    right = np.minimum.accumulate(right[::-1])[::-1]
    trusted = good | ((right - left - 1 <= longest) & (left >= 0) & (right < len(x)))
    inner = trusted & ~good
    trusted[inner] &= run[np.clip(left[inner], 0, None)] == run[np.clip(right[inner], None, len(x) - 1)]
    return out, trusted


def boxcar(x: Array, width: int) -> Array:
    """Centred mean over `width` (odd) rows along axis 0; the ends repeat."""
    if width <= 1:
        return x
    from scipy.ndimage import uniform_filter1d

    return np.asarray(uniform_filter1d(x, width, axis=0, mode="nearest"))
