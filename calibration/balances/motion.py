"""Rates and accelerations of the axis on the analysis grid, all behind the same two boxcars.

With h = box_D * box_D, the second difference over D rows is h * theta'' exactly. The quotient over D rows,
once more smoothed, is h * theta'. So columns smoothed by h balance without bias of a differentiating filter.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import minimum_filter1d

from calibration.arrays import Array, Mask
from calibration.balances.context import direction_of, since_reversal
from calibration.balances.filters import Filter, boxcar, since
from calibration.balances.frame import Frame
from calibration.balances.problem import Problem, Term, labels_of
from calibration.balances.thresholds import UNTOUCHED
from calibration.balances.view import View
from calibration.inputs.declaration import Column, Response, Rig, Stage
from calibration.inputs.thresholds import HARMONICS
from calibration.inputs.train import SHAFT, Train

START_ROWS = 10  # rows after a start or a gap that are not analysed. ASSUMPTION
# rad, 0.4 arcsec: more than the encoder's noise, less than the pre-sliding range. ASSUMPTION
DIRECTION_TRAVEL = 2e-6


@dataclass(kw_only=True)
class Motion(View):
    """An axis by its absolute encoder, in rad, gaps filled; `rows` are those of the analysis grid.

    `speed` and `acceleration` are behind h, which is the `filter`.
    """

    frame: Frame
    acceleration: Array  # rad/s2
    fresh: Mask  # first row of a run or after a long gap
    starts: Mask  # first row of a run

    @property
    def width(self) -> int:
        """D."""
        return self.filter.boxcar

    @property
    def cell_s(self) -> float:
        """Between two rows of the analysis grid."""
        return self.width * self.period_s

    def clear(self, *marked: Mask) -> Mask:
        """Rows of the analysis grid (n_analysis,) whose filter holds no `marked` row (n,)."""
        return self.at(np.logical_or.reduce(marked).astype(float)) < UNTOUCHED

    def problem(self, held: Mask, terms: Sequence[Term], **more: Any) -> Problem:
        """`terms` against y on the analysis grid, motor A first; `held` (n,); `more`: `Problem`'s fields."""
        motors = len(more["y"]) // len(self.rows)
        f = self.frame
        full = {"t": f.t, "run": f.run, "session": f.session, "held": held}
        rows = {k: np.tile(x[self.rows], motors) for k, x in full.items()}
        base = np.column_stack([x for _, _, x in terms])
        given = {"ar_order": 4, "block_s": 3.0, "period_s": self.cell_s, **rows, **more}
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
    turns = direction_of(theta, frame.run, DIRECTION_TRAVEL)
    return Motion(
        rig=_in_radians(frame.rig, frame.train),
        response=Response("current", "N m"),
        period_s=dt,
        filter=Filter(1.0, d),
        t=frame.t,
        clock=frame.one_clock,
        file=frame.run,
        segment=frame.run,
        run=frame.run,
        columns={"position": theta},
        ok=usable,
        rows=np.arange(d // 2, len(theta), d),
        dynamic=True,
        turn=2 * np.pi,
        speed=rate_of(theta, d, dt),
        direction=np.sign(np.gradient(theta)),
        since=since_reversal(theta, turns, frame.run),
        frame=frame,
        acceleration=acceleration_of(theta, d, dt),
        fresh=fresh,
        starts=starts,
    )


def _in_radians(rig: Rig, train: Train) -> Rig:
    """The rig with the stages whose torque the axis feels, periods in rad; its position is absolute."""
    shafts = dict.fromkeys(train.shafts, SHAFT)
    stages = tuple(
        Stage(name, 2 * np.pi / order, None, HARMONICS, shafts.get(name, train.kinds[name]))
        for name, order in train.orders.items()
        if train.kinds[name] not in ("axis", "sensor")  # a sensor may be on a shaft of its own
    )
    columns = rig.columns | {"position": Column("rad")}
    return replace(rig, columns=columns, stages=stages, runs={"origin": "shared"})


def rate_of(x: Array, width: int, period_s: float) -> Array:
    """h * x' at full rate, as `Motion.speed` is of the position; `period_s` between rows."""
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
