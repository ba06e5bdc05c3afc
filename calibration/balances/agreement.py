"""Two columns that say the same: how late one is against the other, and how well they agree."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import convolve1d

from calibration.arrays import Array, Mask
from calibration.balances.filters import by_piece, pieces, smooth
from calibration.balances.noise import row_to_row
from calibration.balances.thresholds import FEWEST_FILES, FEWEST_ROWS, LEAST_SCALE
from calibration.balances.view import View
from calibration.statistics.regression import gls
from calibration.statistics.tails import rms
from calibration.statistics.thresholds import SURE_Z

SCALED = 0.01  # of the scale: less is how either rate was smoothed. ASSUMPTION
# of a rate's rms, its noise: more makes a slope over it a twenty-fifth too small, its square. arithmetic
NOISY = 0.2
MATTERS = 0.2  # of the mean square of what the columns disagree by. ASSUMPTION
SMALLEST = 0.1  # sample periods: a shorter delay is within a reading's own window. ASSUMPTION
IMPULSE = 6  # standard deviations of a Gaussian, beyond which hardly anything of it is left. arithmetic
LONGEST = 20  # sample periods that are looked at. ASSUMPTION


@dataclass(frozen=True)
class Agreement:
    """`channel` is late against the position by `delay_s` +- `error_s` (one standard error). rms is that of
    the difference on held-out rows with and without it. The sensors' noise stands beside it, and `scale` of
    its rate, with error."""

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
    size: float = 0.0  # rms of the position's rate

    @property
    def scaled(self) -> str:
        """In words, when the channel is another multiple of the position's rate than one."""
        if abs(self.scale - 1.0) < max(SURE_Z * self.scale_error, SCALED):
            return ""
        return f"{self.channel} reads {self.scale:.4g} times the position's rate: its unit, scale or sign"

    @property
    def left(self) -> float:
        """Floors that remain between the two columns; 0 where there is none."""
        rest = self.after if self.late else self.before
        return rest / self.floor if np.isfinite(rest) and np.isfinite(self.floor) and self.floor > 0 else 0.0

    @property
    def hardly(self) -> bool:
        """Whether what remains is so small a part of the rate that its smoothing may make it."""
        return (self.after if self.late else self.before) < SCALED * self.size


def velocity_against_position(view: View, held: Mask) -> Agreement | None:
    """A measured velocity against the position's rate: scale and offset are free, then the delay."""
    if "velocity" not in view.columns or view.ok.sum() < FEWEST_ROWS:
        return None
    v, w = view.rate(view.x), by_piece(view.columns["velocity"], view.segment, _over_two_rows)
    sigma = max(view.wide, 2.0)
    v, w = smooth(v, view.segment, sigma), smooth(w, view.segment, sigma)
    a = view.rate(v)
    apart = slice(None, None, max(round(sigma / view.step), 1))  # rows that the smoothing leaves independent
    rows, held = view.rows[apart], held[apart]
    ok = view.ok[rows]
    train = ok & ~held
    test = ok & held if (ok & held).sum() > FEWEST_ROWS else train
    if train.sum() < FEWEST_ROWS or np.std(w[rows][train]) == 0:
        return None
    block = max(int(len(rows) / 60), 20)
    free = np.column_stack([v[rows], np.ones(len(rows)), -a[rows]])
    before = gls(w[rows], free[:, :2], train, 0, block)
    delay = 0.0
    for _ in range(4):  # the slope is exact at the right delay only
        fit = gls(view.delayed(w, delay)[rows], free, train, 0, block)
        scale = float(fit.beta[0]) or 1.0
        step = float(fit.beta[2]) / scale
        delay = float(np.clip(delay + step, -LONGEST * view.period_s, LONGEST * view.period_s))
    error = float(fit.errors[2]) / abs(scale)
    moved = view.delayed(w, delay)[rows]
    error = max(error, _scatter(view.file[rows], free, moved, train))
    last = gls(moved, free[:, :2], train, 0, block)
    b, c = rms(before.residual[test]), rms(last.residual[test])
    noise = row_to_row(view.columns["velocity"], view.ok), view.noise / view.period_s
    passed = (_passed(f, sigma) for f in (_over_two_rows, np.gradient))
    floor = float(np.hypot.reduce([x * gain for x, gain in zip(noise, passed, strict=True)]))
    late = (
        abs(delay) > SURE_Z * error
        and SMALLEST * view.period_s < abs(delay) < LONGEST * view.period_s  # at an end it is none
        and 1 - (c / b) ** 2 > MATTERS
        and abs(scale) > LEAST_SCALE
    )
    unit = view.rig.columns["velocity"].unit
    own, spread = float(last.beta[0]), float(last.errors[0])
    size = rms(v[rows][test])
    noisy = noise[1] * _passed(np.gradient, sigma) > NOISY * size
    if noisy or abs(_of_the_travel(view) - 1.0) < SCALED:  # rows that repeat spoil the rates, not the way
        own = 1.0
    return Agreement("velocity", unit, delay, error, b, c, floor, late, own, spread, size)


def _of_the_travel(view: View) -> float:
    """The velocity's sum over the way between reversals, in parts of that way."""
    v = view.columns["velocity"]
    ways = pieces(np.cumsum(np.diff(np.sign(view.direction), prepend=0.0) != 0) + 10**6 * view.segment)
    ends = [(view.x[b - 1] - view.x[a], float(np.sum(v[a:b]) - (v[a] + v[b - 1]) / 2)) for a, b in ways]
    way, total = np.array(ends).T
    return float(way @ total * view.period_s / max(float(way @ way), 1e-300))


def _over_two_rows(rate: Array) -> Array:
    """Mean (n,) of a rate over the rows before and behind, as the position's central difference has it.

    Simpson's rule; a quick wave is dimmed alike in both.
    """
    return np.asarray(convolve1d(rate, np.array([1.0, 4.0, 1.0]) / 6.0, mode="nearest"))


def _passed(what: Callable[[Array], Array], sigma: float) -> float:
    """Part of white noise's rms that is left of it behind `what` and a Gaussian of `sigma` rows."""
    one = np.zeros(2 * round(IMPULSE * sigma) + 1)
    one[len(one) // 2] = 1.0
    return float(np.linalg.norm(smooth(what(one), np.zeros(len(one), dtype=np.int64), sigma)))


def _scatter(files: NDArray[np.int64], x: Array, y: Array, train: Mask) -> float:
    """Standard error of the delay from what single files say; 0 for fewer than three."""
    each = [train & (files == k) for k in np.unique(files)]
    fits = [np.linalg.lstsq(x[m], y[m], rcond=None)[0] for m in each if m.sum() > FEWEST_ROWS]
    found = [float(beta[2]) for beta in fits]
    return float(np.std(found, ddof=1) / np.sqrt(len(found))) if len(found) >= FEWEST_FILES else 0.0
