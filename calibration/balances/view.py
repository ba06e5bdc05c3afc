"""A drive's records at full rate, and the way from there to the rows that are fitted.

Every column of a balance goes through the same filter, so that the balance holds between filtered columns
without bias. Rates are plain differences of the position, smoothed afterwards like everything else.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from calibration.arrays import Array, Mask
from calibration.balances.context import direction_of, since_reversal, turning_points
from calibration.balances.filters import Filter, by_piece, pieces, smooth
from calibration.balances.frame import SHORT
from calibration.balances.noise import position_noise
from calibration.balances.width import LEAST_OF_SENSORS, USUAL, Limits, passing_waves, told_by_noise
from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Response, Rig
from calibration.inputs.run import Run, rows_per_reading, step_of
from calibration.inputs.thresholds import GAP
from calibration.inputs.units import units_per_turn
from calibration.statistics.thresholds import SURE_Z

SLOWEST = 0.01  # of the usual top speed: slower, friction may have any size up to break-away. ASSUMPTION
REACH = 3.0  # standard deviations of the filter: nearer to an edge or a bad row is not used. ASSUMPTION
# of the usual top speed: slower is standing. How sharply friction turns is fitted, from these. ASSUMPTION
STANDSTILLS = (0.0005, 0.001, 0.002, 0.005, 0.01, 0.02)
MOST_ROWS = 24_000  # rows that are fitted: more are averaged together. ASSUMPTION
# harmonics of all stages, from where on fewer rows are fitted: time grows with their square. ASSUMPTION
MOST_WAVES = 24
ROWS_PER_WAVE = 4.0  # rows per period of the quickest of them. ASSUMPTION: Nyquist's two, twice
SENSOR_ROWS = 4_000  # rows of one sensor against another, which has no accelerations to follow. ASSUMPTION
WINDOW = 5.0  # standard deviations of the filter in `smooth_s`. definition
FEWEST = 3  # rows of a second difference. definition
LEAST_WIDTH = 0.5  # rows, of the speed's smoothing: a central difference, two rows, has 0.58. arithmetic
RESOLVED = 6.0  # steps of the position's sensor that a travel must have before its shape is seen. ASSUMPTION
# rows per reading of a column, from where on its noise is told reading by reading. ASSUMPTION: not a few gaps
SELDOM = 1.5
HALF = 0.5  # part of 1, from where on a direction is one. definition
# share of the rows in either direction: fewer say nothing of a difference between the two. ASSUMPTION
BOTH = 0.05


@dataclass(kw_only=True)
class View:
    """Full-rate columns (n,) of all records, one after the other, each on a regular grid of `period_s`.

    `t`: a file's time, `clock`: of all. `ok`: sound neighbourhood; `rows`: fitted, behind `filter`.
    """

    rig: Rig
    response: Response
    period_s: float
    filter: Filter
    t: Array
    clock: Array
    file: NDArray[np.int64]
    segment: NDArray[np.int64]
    run: NDArray[np.int64]
    columns: dict[str, Array]
    ok: Mask
    rows: NDArray[np.int64]
    dynamic: bool  # the balance holds accelerations
    turn: float | None  # position units per turn
    rates: float = 0.0  # standard deviation, rows, by which rates and accelerations are smoothed
    quanta: dict[str, float] = field(default_factory=dict)  # steps of the columns, as they were logged
    seldom: dict[str, int] = field(default_factory=dict)  # rows per reading of what is read less often
    in_order: bool = False  # several files whose clock nobody declared: `clock` is their order's
    slow: float = 0.0  # speed below which a driven axis may stand: its friction is then not known
    slow_offset: int | None = None  # cosines per file by which the response's offset wanders; 0: a constant
    standstill: float = 0.0  # speed, position units per s, below which the direction fades
    speed: Array = field(default_factory=lambda: np.zeros(0))  # smoothed, for what is not linear in it
    direction: Array = field(default_factory=lambda: np.zeros(0))
    since: Array = field(default_factory=lambda: np.zeros(0))  # travel since the last reversal

    @property
    def sigma(self) -> float:
        """Standard deviation of the filter, rows."""
        return self.filter.sigma

    @property
    def wide(self) -> float:
        """Likewise, of the position's rates and accelerations."""
        return max(self.sigma, self.rates)

    @property
    def x(self) -> Array:
        """Position."""
        return self.columns["position"]

    @property
    def unit(self) -> str:
        """Of the response."""
        return self.response.unit

    @property
    def angle_unit(self) -> str:
        """Of the position."""
        return self.rig.columns["position"].unit

    @cached_property
    def noise(self) -> float:
        """rms of the position's noise and rounding, position units."""
        return position_noise(self.x, self.file, self.quanta.get("position"))

    @property
    def resolved(self) -> float:
        """Travel, position units, below which what happens after a reversal is the sensor's."""
        return RESOLVED * float(np.sqrt(12.0)) * self.noise

    @property
    def top(self) -> float:
        """Usual top speed, position units per s."""
        return float(np.quantile(np.abs(self.speed[self.ok]), 0.95)) if self.ok.any() else 0.0

    @property
    def both(self) -> bool:
        """True when the drive goes both ways."""
        d = self.direction[self.ok]
        return bool(min(np.mean(d > HALF), np.mean(d < -HALF)) > BOTH) if len(d) else False

    @property
    def step(self) -> int:
        """Full-rate rows per fitted row."""
        return int(self.rows[1] - self.rows[0]) if len(self.rows) > 1 else 1

    def at(self, full: Array) -> Array:
        """A full-rate column (n,) or columns (n, k) through the filter, on the fitted rows."""
        return np.asarray(self.filter(full, self.segment)[self.rows])

    def rate(self, full: Array) -> Array:
        """Central difference per second within segments."""
        return by_piece(full, self.segment, lambda x: np.gradient(x, self.period_s), FEWEST)

    def smoothed(self, full: Array) -> Array:
        """A rate or acceleration (n,) of the position before the filter.

        It is smoothed where the filter lets declared waves pass that are quicker than the position resolves
        in a rate.
        """
        return smooth(full, self.segment, self.rates) if self.rates > self.sigma else full

    def second(self, full: Array) -> Array:
        """Second difference per second squared within segments; 0 at their ends."""
        return by_piece(full, self.segment, lambda x: np.pad(np.diff(x, 2), 1) / self.period_s**2, FEWEST)

    def delayed(self, full: Array, delay_s: float) -> Array:
        """What the column would have shown, had it not been late by `delay_s`."""
        if delay_s == 0.0:
            return full
        late, row = delay_s / self.period_s, np.arange(len(full))
        return by_piece(full, self.segment, lambda x: np.interp(row[: len(x)] + late, row[: len(x)], x), 3)


def view_of(records: list[Run], rig: Rig, response: Response, limits: Limits = USUAL) -> View:
    """All records on one grid; the filter from the rig file, or within `limits` from the position's noise."""
    period = float(np.median([r.period_s for r in records]))
    parts = [_regular(r, period) for r in records]
    if max(len(p["t"]) for p in parts) < FEWEST:
        raise CalibrationInputError(records[0].path, "no three rows follow each other in time")
    file = np.concatenate([np.full(len(p["t"]), k) for k, p in enumerate(parts)]).astype(np.int64)
    columns = {k: np.concatenate([p[k] for p in parts]) for k in parts[0]}
    t, ok, gap = columns.pop("t"), columns.pop("ok") > 0, columns.pop("gap") > 0
    starts = np.array([r.start_s or 0.0 for r in records])
    heavy = "inertia" in (*rig.estimate, *rig.constants)
    dynamic = response.is_force and (heavy or response.channel == "acceleration")
    # as they were logged: on a grid of its own a column has none
    quanta = {k: step for k in columns if (step := step_of(records, k)) is not None}
    noise = position_noise(columns["position"], file, quanta.get("position"))
    told = told_by_noise(columns["position"], file, noise, limits)
    told = told if dynamic else max(told, LEAST_OF_SENSORS)
    sigma = told if rig.smooth_s is None else rig.smooth_s / WINDOW / period
    passing = passing_waves(columns["position"], file, rig, sigma, limits.least)
    if dynamic:
        gap &= ~_filtered_over(gap, sigma)
    apart = gap if dynamic else gap & ~_stood_over(columns["position"], gap, rig)
    fresh = np.concatenate([[True], (np.diff(file) != 0) | (apart[1:] != apart[:-1])])
    view = View(
        rig=rig,
        response=response,
        period_s=period,
        filter=Filter(min(sigma, passing) if dynamic else 0.0),
        t=t,
        clock=t + starts[file],
        file=file,
        segment=np.cumsum(fresh),
        run=file,  # or shorter, by turning points
        columns=columns,
        ok=ok & ~gap,
        rows=np.zeros(0, dtype=np.int64),
        dynamic=dynamic,
        rates=sigma if dynamic else 0.0,
        turn=rig.turn or units_per_turn(rig.columns["position"].unit),
        quanta=quanta,
        in_order=len(records) > 1 and any(r.in_order for r in records),
        seldom={k: round(share) for k in columns if (share := rows_per_reading(records, k)) > SELDOM},
    )
    _motion(view, max(sigma, told))  # whether it moves is seen through no narrower filter
    if rig.runs.get("by") == "turning_points":
        least = float(rig.runs.get("minimum_travel", 0.0))
        view.run = np.cumsum(turning_points(view.x, file, least)).astype(np.int64)
    choose_rows(view)
    return view


def _regular(record: Run, period: float) -> dict[str, Array]:
    """One record on a regular grid; rows in a gap, and near longer stretches without numbers, are not ok."""
    t = record.columns["t"]
    grid: Array = np.arange(int(np.floor((t[-1] - t[0]) / period)) + 1) * np.float64(period)
    out = {"t": grid}
    right = np.clip(np.searchsorted(t, grid), 1, len(t) - 1)
    wide = t[right] - t[right - 1] > max(record.gap_s, GAP * period)
    inside = np.minimum(np.abs(t[right] - grid), np.abs(t[right - 1] - grid)) > 0.51 * period
    ok = np.ones(len(grid), dtype=bool)
    for name, x in record.columns.items():
        good = np.isfinite(x)
        if name != "t":
            out[name] = np.interp(grid, t[good], x[good])
            for a, b in pieces(good.astype(np.int64)):
                if not good[a] and b - a > SHORT:
                    ok &= (grid < t[a]) | (grid > t[b - 1])
    return out | {"gap": (wide & inside).astype(float), "ok": ok.astype(float)}


def _filtered_over(gap: Mask, sigma: float) -> Mask:
    """Rows of gaps that are shorter than the filter's standard deviation, rows: a row stands for as much."""
    out = np.zeros(len(gap), dtype=bool)
    for a, b in pieces(gap.astype(np.int64)):
        out[a:b] = b - a < sigma
    return out


def _stood_over(x: Array, gap: Mask, rig: Rig) -> Mask:
    """Rows of gaps over which the position (n,) goes no further than a limit.

    The limit is the larger of two. One is the usual travel within as short a time as makes no gap, the other
    a part of the shortest declared wave. A log of events has few rows while nothing moves, and a balance
    without accelerations needs no rate.
    """
    rows = round(GAP)
    steps = np.abs(x[rows:] - x[:-rows])[~gap[rows:]]
    waves = [g.period / g.harmonics / ROWS_PER_WAVE for g in rig.stages if g.period]
    usual = max(float(np.quantile(steps, 0.95)) if len(steps) else 0.0, min(waves, default=0.0))
    out = np.zeros(len(x), dtype=bool)
    for a, b in pieces(gap.astype(np.int64)):
        out[a:b] = gap[a] and abs(x[min(b, len(x) - 1)] - x[max(a - 1, 0)]) <= usual
    return out


def acceleration(view: View) -> Array:
    """Full-rate acceleration (n,), smoothed until the position's noise is a small part of it."""
    width = told_by_noise(view.x, view.file, view.noise)
    return smooth(view.second(view.x), view.segment, width)


def least_travel(x: Array) -> float:
    """Travel that counts as motion: above the position's noise, and a ten-thousandth of the range."""
    reach = float(np.quantile(x, 0.99) - np.quantile(x, 0.01))
    return max(1e-4 * reach, 12 * float(np.median(np.abs(np.diff(x, 2)))))


def _motion(view: View, sigma: float) -> None:
    """Speed, direction and travel since the last reversal."""
    width = max(sigma / 2, 1.0)
    soft = smooth(view.x, view.segment, width)
    view.speed = smooth(view.rate(view.x), view.segment, width)  # at an edge `soft` stands still
    view.direction = direction_of(soft, view.file, least_travel(soft))
    view.since = since_reversal(soft, view.direction, view.file)
    if view.dynamic:  # a driven axis also stands still: there its friction has no direction
        unsure = SURE_Z * view.noise / view.period_s / np.sqrt(4 * np.sqrt(np.pi))  # smoothed over a row
        view.slow = max(unsure / width**1.5, SLOWEST * view.top)
        # a reversal between two accelerations moves with the smoothing: no more than the noise asks for
        width = min(width, max((unsure / (view.slow or 1.0)) ** (2 / 3), LEAST_WIDTH))
        view.speed = smooth(view.rate(view.x), view.segment, width)
        fade(view, STANDSTILLS[3])


def fade(view: View, part: float) -> None:
    """Let the direction fade below `part` of the usual top speed."""
    view.standstill = part * view.top
    view.direction = np.tanh(view.speed / (view.standstill or 1.0))


def choose_rows(view: View) -> None:
    """Rows that are fitted: one per filter width, and no more than can be fitted in time."""
    period = view.rig.analyse_period_s
    step = round(period / view.period_s) if period else round(view.sigma)
    most = MOST_ROWS if view.response.is_force else SENSOR_ROWS
    most = most * MOST_WAVES // max(sum(len(g.orders) for g in view.rig.stages), MOST_WAVES)
    # but enough for the quickest of the declared lines at the usual top speed
    rate = max((g.harmonics / g.period for g in view.rig.stages if g.period), default=0.0)
    most = max(most, int(len(view.t) * view.period_s * view.top * rate * ROWS_PER_WAVE))
    step = max(step, 1, int(np.ceil(len(view.t) / most)) if not period else 1)
    if view.sigma == 0 and step > 1 and not period:
        view.filter = Filter(step / 2)
    view.rows = np.concatenate([np.arange(a, b, step) for a, b in pieces(view.file)])
    margin = int(np.ceil(REACH * view.wide)) + (1 if view.dynamic else 0)
    edge = np.zeros(len(view.t), dtype=bool)
    for a, b in pieces(view.segment):
        edge[a : a + margin] = True
        edge[max(b - margin, a) : b] = True
    # the filter carries what stands in for bad rows over to their neighbours
    if view.dynamic and not view.ok.all():
        edge |= maximum_filter1d(~view.ok, 2 * margin + 1)
    view.ok &= ~edge
