"""Axis logs on one regular grid: gaps are NaN rows, runs follow each other, every column in SI units."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.arrays import Array, Mask
from calibration.balances.filters import pieces, since
from calibration.balances.thresholds import COLUMN_PRESENT
from calibration.inputs.declaration import Rig
from calibration.inputs.rigfile import telescope
from calibration.inputs.rows import jumps_of_clock
from calibration.inputs.run import Run
from calibration.inputs.train import Train, train_of

SENSORS = ("effort", "position", "velocity", "current_a", "current_b", "motor_a", "motor_b", "aux")
# "unseen" is 1 where the position is not measured but carried on from the motors; no log has it
COLUMNS = (*SENSORS, "setpoint", "supply", "temperature", "unseen")

FAR_APART = 50  # times the logged time: runs that far apart are not one session. ASSUMPTION
# share of full effort within one row: a transient that the rigid balance does not hold. ASSUMPTION
JUMP = 0.02
# how long such a transient lasts: a few turns of the lock-rotor mode and of the PI loop. ASSUMPTION
SETTLE_S = 0.25
SHORT = 3  # rows without a number that are bridged by a straight line. ASSUMPTION


@dataclass(kw_only=True)
class Frame:
    """Columns (n,) at the log's sample period; `run`, `session` integer labels; `clock` as logged."""

    runs: list[Run]
    period_s: float
    t: Array  # s since the first row of the first run, nominal grid; runs are kept apart by their start times
    clock: Array  # logged stamp minus nominal grid, s; NaN where the row is missing
    run: NDArray[np.int64]
    session: NDArray[np.int64]
    columns: dict[str, Array]
    scale: dict[str, float]
    rig: Rig  # the drive's declaration
    jumps: list[float] = field(default_factory=list)  # of the clock, s, that `clock` is without

    @property
    def train(self) -> Train:
        """The declared gear train."""
        return train_of(self.rig)

    @property
    def one_clock(self) -> Array:
        """Time of every row, s, by the runs' starts; by the order of files where one is not told nearby."""
        begin = [r.start_s for r in self.runs if r.start_s is not None]
        if len(begin) < len(self.runs):
            return self.t
        out = self.t.copy()
        for k, start in enumerate(begin):
            rows = self.run == k
            if rows.any():
                out[rows] += start - min(begin) - self.t[rows].min()
        return out if np.ptp(out) < FAR_APART * np.ptp(self.t) + 1 else self.t

    @property
    def gaps(self) -> list[int]:
        """Rows that are missing at a time."""
        return [b - a for a, b in pieces(self.present.astype(np.int64)) if not self.present[a]]

    @property
    def present(self) -> Mask:
        """Rows that are in the log."""
        return np.isfinite(self.clock)

    def get(self, name: str) -> Array | None:
        """A column, or None when no run has it."""
        x = self.columns.get(name)
        return x if x is not None and np.isfinite(x).mean() > COLUMN_PRESENT else None

    def filled(self, name: str) -> tuple[Array, Mask]:
        """A column with its gaps interpolated, and where it may be trusted; zeros when no run has it."""
        x = self.get(name)
        return (np.zeros(len(self.t)), np.ones(len(self.t), dtype=bool)) if x is None else fill(x, self.run)

    def transients(self) -> Mask:
        """Rows within SETTLE_S after a jump of the effort, or two rows before it."""
        effort, _ = self.filled("effort")
        jump = np.zeros(len(effort), dtype=bool)
        jump[1:] = (np.abs(np.diff(effort)) > JUMP) & (self.run[1:] == self.run[:-1])
        near = since(jump) <= round(SETTLE_S / self.period_s)
        near[:-1] |= jump[1:]
        near[:-2] |= jump[2:]
        return np.asarray(near)

    def saturated(self, current: Array) -> Mask:
        """Rows where a current's converter is at its end."""
        return np.asarray(current >= self.scale["adc_end_A"])


def build_frame(runs: list[Run], rig: Rig | None = None) -> Frame:
    """All runs of one axis on one grid, NaN between samples; `rig`: the telescope's axis without it."""
    period = runs[0].scales["sample_period_s"]
    sessions = {s: k for k, s in enumerate(dict.fromkeys(r.session for r in runs))}
    parts: list[dict[str, NDArray[Any]]] = []
    jumps: list[float] = []
    offset = 0.0
    for index, r in enumerate(runs):
        t = r.columns["t"]
        steps = _steps(t, period)
        jump = np.where(jumps_of_clock(r.columns["position"], steps), np.diff(t) - period, 0.0)
        jumps += jump[jump != 0].tolist()
        place = np.concatenate([[0], np.cumsum(np.where(jump != 0, 1, steps))]).astype(np.int64)
        n = int(place[-1]) + 1
        grid = t[0] + period * np.arange(n)
        logged = {**r.columns, "clock": t - grid[place] - np.concatenate([[0], np.cumsum(jump)])}
        part = {name: np.full(n, np.nan) for name in ("clock", *COLUMNS)}
        for name in part.keys() & logged.keys():
            part[name][place] = logged[name]
        shifted = grid - grid[0] + offset
        labels = {"run": np.full(n, index), "session": np.full(n, sessions[r.session])}
        parts.append(part | {"t": shifted} | labels)
        offset = shifted[-1] + 10 * period
    joined = {k: np.concatenate([part[k] for part in parts]) for k in parts[0]}
    return Frame(
        **{k: joined[k] for k in ("t", "clock", "run", "session")},
        runs=runs,
        period_s=period,
        columns={k: joined[k] for k in COLUMNS},
        scale=dict(runs[0].scales),
        rig=rig or telescope(runs[0].header["axis"]),
        jumps=jumps,
    )


def _steps(t: Array, period: float) -> NDArray[np.int64]:
    """Periods (n - 1,) from row to row: one unless stamps show a gap."""
    step = np.maximum(np.round(np.diff(t) / period), 1).astype(np.int64)
    # a drifting or jittering stamp must not open a gap: count gaps only where the stamp jumps by 1.6 periods
    step[np.diff(t) < 1.6 * period] = 1
    return step


def fill(x: Array, run: NDArray[np.int64]) -> tuple[Array, Mask]:
    """Linear interpolation over gaps: the filled column, and where it may be trusted (SHORT gaps only)."""
    good = np.isfinite(x)
    if not good.any():
        return np.zeros_like(x), good
    index, trusted = np.arange(len(x)), good.copy()
    for a, b in pieces(good.astype(np.int64)):
        if not good[a] and b - a <= SHORT and a > 0 and b < len(x):
            trusted[a:b] = run[a - 1] == run[b]
    return np.interp(index, index[good], x[good]), trusted
