"""Two columns that say the same: how late one is against the other, and how well they agree."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from calibration.channels.view import View
from calibration.readers.run import Array
from calibration.statistics.regression import gls
from calibration.statistics.whitening import Mask

SIGNIFICANT = 4.0  # standard errors
SCALED = 0.01  # of the scale: less is how either rate was smoothed
MATTERS = 0.2  # of the mean square of what the columns disagree by
SMALLEST = 0.1  # sample periods: a shorter delay is within a reading's own window
LONGEST = 20  # sample periods that are looked at
FEWEST = 200  # rows


@dataclass(frozen=True)
class Agreement:
    """`channel` against the position: late by `delay_s` +- `error_s` (one standard error); rms of the
    difference on held-out rows before and after the delay is taken out, and the sensors' own noise; `scale`
    +- `scale_error`: what the channel reads of the position's rate."""

    channel: str
    unit: str
    delay_s: float
    error_s: float
    before: float
    after: float
    floor: float
    late: bool
    scale: float = 1.0
    scale_error: float = 0.0

    @property
    def scaled(self) -> str:
        """In words, when the channel is another multiple of the position's rate than one."""
        if abs(self.scale - 1.0) < max(SIGNIFICANT * self.scale_error, SCALED):
            return ""
        return f"{self.channel} reads {self.scale:.4g} times the position's rate: its unit, scale or sign"

    @property
    def left(self) -> float:
        """Floors that remain between the two columns; 0 where there is none."""
        rest = self.after if self.late else self.before
        return rest / self.floor if np.isfinite(rest) and np.isfinite(self.floor) and self.floor > 0 else 0.0


def velocity_against_position(view: View, held: Mask) -> Agreement | None:
    """A measured velocity against the position's rate: scale and offset are free, then the delay."""
    if "velocity" not in view.columns or view.ok.sum() < FEWEST:
        return None
    v, w = view.rate(view.x), view.columns["velocity"]
    sigma = max(view.sigma, 2.0)
    from calibration.channels.view import smooth

    v, w = smooth(v, view.segment, sigma), smooth(w, view.segment, sigma)
    a = view.rate(v)
    rows = view.rows
    ok = view.ok[rows]
    train = ok & ~held
    test = ok & held if (ok & held).sum() > FEWEST else train
    if train.sum() < FEWEST or np.std(w[rows][train]) == 0:
        return None
    one = np.ones(len(rows))
    block = max(int(len(rows) / 60), 20)
    before = gls(w[rows], np.column_stack([v[rows], one]), train, 0, block)
    delay, fit = 0.0, before
    for _ in range(4):  # the slope is exact at the right delay only
        moved = view.delayed(w, delay)
        fit = gls(moved[rows], np.column_stack([v[rows], one, -a[rows]]), train, 0, block)
        scale = float(fit.beta[0]) or 1.0
        step = float(fit.beta[2]) / scale
        delay = float(np.clip(delay + step, -LONGEST * view.period_s, LONGEST * view.period_s))
    error = float(np.sqrt(max(fit.covariance[2, 2], 0.0))) / abs(scale)
    error = max(error, _scatter(view, w, delay, a, v, train))
    last = gls(view.delayed(w, delay)[rows], np.column_stack([v[rows], one]), train, 0, block)
    b, c = _rms(before.residual[test]), _rms(last.residual[test])
    floor = _noise(last.residual, test)
    late = (
        abs(delay) > SIGNIFICANT * error
        and abs(delay) > SMALLEST * view.period_s
        and 1 - (c / b) ** 2 > MATTERS
        and abs(scale) > 0.3
    )
    unit = view.rig.columns["velocity"].unit
    spread = float(np.sqrt(max(last.covariance[0, 0], 0.0)))
    return Agreement("velocity", unit, delay, error, b, c, floor, late, float(last.beta[0]), spread)


def _scatter(view: View, w: Array, delay: float, a: Array, v: Array, train: Mask) -> float:
    """Standard error of the delay from what single files say; 0 for fewer than three."""
    files = view.file[view.rows]
    moved = view.delayed(w, delay)[view.rows]
    found = []
    for k in np.unique(files):
        rows = train & (files == k)
        if rows.sum() > FEWEST:
            x = np.column_stack([v[view.rows], np.ones(len(files)), -a[view.rows]])[rows]
            found.append(float(np.linalg.lstsq(x, moved[rows], rcond=None)[0][2]))
    return float(np.std(found, ddof=1) / np.sqrt(len(found))) if len(found) >= 3 else 0.0


def _rms(x: Array) -> float:
    return float(np.sqrt(np.mean(x**2))) if len(x) else float("nan")


def _noise(e: Array, rows: Mask) -> float:
    """rms of what changes from row to row: fourth differences of white noise have 70 times its variance."""
    x = np.where(rows, e, np.nan)
    fourth = x[4:] - 4 * x[3:-1] + 6 * x[2:-2] - 4 * x[1:-3] + x[:-4]
    fourth = fourth[np.isfinite(fourth)]
    return float(np.sqrt(np.mean(fourth**2) / 70.0)) if len(fourth) > 20 else float("nan")
