"""What moved: rates and accelerations of the axis on the analysis grid, each as a mean over the same two
boxcars.

With h = box_D * box_D, the second difference of the position over D rows is h * theta'' exactly, the
difference quotient
over D rows smoothed once more is h * theta', and every other column is smoothed by h: the torque balance
then holds
between the smoothed columns without any bias of a differentiating filter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.channels.frame import Frame, boxcar, fill
from calibration.readers.run import Array
from calibration.statistics.whitening import Mask


@dataclass
class Motion:
    """Full-rate position, and h-smoothed rate and acceleration; `pick` are the rows of the analysis grid."""

    width: int
    theta: Array  # rad, gaps filled
    trusted: Mask
    rate: Array  # rad/s
    acceleration: Array  # rad/s2
    pick: NDArray[np.int64]
    fresh: Mask  # first row of a run or after a long gap
    starts: Mask  # first row of a run
    period_s: float

    def smooth(self, x: Array) -> Array:
        """h * x at full rate."""
        return boxcar(boxcar(x, self.width), self.width)

    def curvature(self, x: Array) -> Array:
        """h * x'' at full rate."""
        d = self.width
        return (_shift(x, -d) - 2 * x + _shift(x, d)) / self.period_s**2

    def at(self, x: Array) -> Array:
        """h * x on the analysis grid; `x` is (n,) or (n, k)."""
        return np.asarray(self.smooth(x)[self.pick])


START_ROWS = 10  # rows after a start or a gap that are not analysed


def motion_of(frame: Frame, width: int) -> Motion:
    """Motion from the absolute encoder; `width` D is odd."""
    dt = frame.period_s
    theta, trusted = fill(frame.columns["position"], frame.run)
    same = np.ones(len(theta), dtype=bool)
    same[1:] = frame.run[1:] == frame.run[:-1]
    starts = ~same
    fresh = starts.copy()
    fresh |= trusted & ~np.concatenate([[False], trusted[:-1]])
    unseen = frame.get("unseen")
    if unseen is not None:  # no gap of the log: the path goes on, but says nothing of accelerations
        trusted = trusted & ~(unseen > 0)
    d = width
    rate, acceleration = rate_of(theta, d, dt), acceleration_of(theta, d, dt)
    usable = trusted.copy()
    for k in range(1, d + 1):
        usable &= _shift(trusted.astype(float), -k) > 0
        usable &= _shift(trusted.astype(float), k) > 0
        usable &= (_shift(frame.run.astype(float), -k) == frame.run) & (
            _shift(frame.run.astype(float), k) == frame.run
        )
    usable[:d] = usable[len(usable) - d :] = False
    last = np.maximum.accumulate(np.where(fresh, np.arange(len(theta)), -(10**9)))
    usable &= np.arange(len(theta)) - last >= START_ROWS  # the bristles and the first step of the effort
    pick = np.arange(d // 2, len(theta), d)
    return Motion(d, theta, usable, rate, acceleration, pick, fresh, starts, d * dt)


def rate_of(x: Array, width: int, period_s: float) -> Array:
    """h * x' at full rate, as `Motion.rate` is of the position; `period_s` between rows."""
    half = width // 2
    if width == 1:
        return np.asarray((_shift(x, -1) - _shift(x, 1)) / (2 * period_s))
    slope = (_shift(x, -half - 1) + _shift(x, -half) - _shift(x, half) - _shift(x, half + 1)) / 2
    return boxcar(slope / ((2 * half + 1) * period_s), width)


def acceleration_of(x: Array, width: int, period_s: float) -> Array:
    """h * x'' at full rate, as `Motion.acceleration` is of the position."""
    return np.asarray((_shift(x, -width) - 2 * x + _shift(x, width)) / (width * period_s) ** 2)


def _shift(x: Array, by: int) -> Array:
    """x[k - by], ends repeated."""
    if by == 0:
        return x
    out = np.empty_like(x)
    if by > 0:
        out[by:], out[:by] = x[:-by], x[0]
    else:
        out[:by], out[by:] = x[-by:], x[-1]
    return out
