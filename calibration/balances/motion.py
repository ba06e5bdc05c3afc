"""Rates and accelerations of the axis on the analysis grid, all behind the same two boxcars.

With h = box_D * box_D, the second difference over D rows is h * theta'' exactly. The quotient over D rows,
once more smoothed, is h * theta'. So columns smoothed by h balance without bias of a differentiating filter.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import minimum_filter1d

from calibration.arrays import Array, Mask
from calibration.balances.filters import Filter, boxcar, since
from calibration.balances.frame import Frame
from calibration.balances.problem import Problem, Term, labels_of
from calibration.balances.thresholds import UNTOUCHED

# rows after a start or a gap that are not analysed. ASSUMPTION
START_ROWS = 10


@dataclass(kw_only=True)
class Motion:
    """Full-rate position, and h-smoothed rate and acceleration; `pick` are the rows of the analysis grid."""

    frame: Frame
    width: int
    theta: Array  # rad, gaps filled
    trusted: Mask
    rate: Array  # rad/s
    acceleration: Array  # rad/s2
    pick: NDArray[np.int64]
    fresh: Mask  # first row of a run or after a long gap
    starts: Mask  # first row of a run
    period_s: float

    @property
    def filter(self) -> Filter:
        """h; about a row wide."""
        return Filter(1.0, self.width)

    def clear(self, *marked: Mask) -> Mask:
        """Rows of the analysis grid (n_analysis,) whose filter holds no `marked` row (n,)."""
        return self.at(np.logical_or.reduce(marked).astype(float)) < UNTOUCHED

    def at(self, x: Array) -> Array:
        """h * x on the analysis grid; `x` is (n,) or (n, k)."""
        return np.asarray(self.filter(x, self.frame.run)[self.pick])

    def problem(self, held: Mask, terms: Sequence[Term], **more: Any) -> Problem:
        """`terms` against y on the analysis grid, motor A first; `held` (n,); `more`: `Problem`'s fields."""
        motors = len(more["y"]) // len(self.pick)
        f = self.frame
        full = {"t": f.t, "run": f.run, "session": f.session, "held": held}
        rows = {k: np.tile(x[self.pick], motors) for k, x in full.items()}
        base = np.column_stack([x for _, _, x in terms])
        given = {"ar_order": 4, "block_s": 3.0, "period_s": self.period_s, **rows, **more}
        return Problem(base=base, base_labels=labels_of(terms), **given)


def motion_of(frame: Frame, width: int) -> Motion:
    """Motion from the absolute encoder; `width` D is odd."""
    d, dt = width, frame.period_s
    theta, trusted = frame.filled("position")
    starts = np.concatenate([[False], frame.run[1:] != frame.run[:-1]])
    fresh = starts | (trusted & ~np.concatenate([[False], trusted[:-1]]))
    unseen = frame.get("unseen")
    if unseen is not None:  # no gap of the log: the path goes on, but says nothing of accelerations
        trusted = trusted & ~(unseen > 0)
    one_run = _shift(frame.run, d) == _shift(frame.run, -d)
    usable = minimum_filter1d(trusted, 2 * d + 1) & one_run
    usable[:d] = usable[len(usable) - d :] = False
    usable &= since(fresh) >= START_ROWS  # the bristles and the first step of the effort
    return Motion(
        frame=frame,
        width=d,
        theta=theta,
        trusted=usable,
        rate=rate_of(theta, d, dt),
        acceleration=acceleration_of(theta, d, dt),
        pick=np.arange(d // 2, len(theta), d),
        fresh=fresh,
        starts=starts,
        period_s=d * dt,
    )


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


def _shift(x: NDArray[Any], by: int) -> NDArray[Any]:
    """x[k - by], ends repeated."""
    return x[np.clip(np.arange(len(x)) - by, 0, len(x) - 1)]
