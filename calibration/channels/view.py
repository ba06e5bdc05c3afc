"""A drive's records at full rate, and the way from there to the rows that are fitted.

Every column of a balance goes through the same filter, so that the balance holds between filtered columns
without bias: rates are plain differences of the position, smoothed afterwards like everything else.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from calibration.candidates.context import direction_of, since_reversal, turning_points
from calibration.inputs.declaration import Response, Rig
from calibration.inputs.record import GAP, Record, quantum
from calibration.inputs.units import units_per_turn
from calibration.readers.run import Array
from calibration.statistics.whitening import Mask

SLOWEST = 0.01  # of the usual top speed: slower, friction may have any size up to break-away
SURE = 4.0  # standard errors of the speed that the position's noise leaves
REACH = 3.0  # standard deviations of the filter: nearer to an edge or a bad row is not used
SHORT = 3  # rows without a number that are bridged by a straight line
# of the usual top speed: slower is standing. How sharply friction turns is fitted, from these
STANDSTILLS = (0.0005, 0.001, 0.002, 0.005, 0.01, 0.02)
MOST_ROWS = 24_000  # that are fitted: more are averaged together
SENSOR_ROWS = 4_000  # of one sensor against another, which has no accelerations to follow
WINDOW = 5.0  # standard deviations of the filter in `smooth_s`
NOISE = 0.01  # of the acceleration's rms, that the position's noise may leave in it
LEAST, MOST = 2.0, 40.0  # rows: standard deviation of the filter, where the rig file does not say it


RESOLVED = 6.0  # steps of the position's sensor that a travel must have before its shape is seen


@dataclass
class View:
    """Full-rate columns (n,) of all records, one after the other, each on a regular grid of `period_s`.

    `t` is the file's own time, `clock` the one that all files share. `ok` marks rows whose neighbourhood is
    sound, `rows` those that are fitted. Units are the rig's.
    """

    rig: Rig
    response: Response
    period_s: float
    sigma: float  # rows, of the filter that `at` applies
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
    slow: float = 0.0  # speed below which a driven axis may stand: its friction is then not known
    slow_offset: int = 0  # cosines per file by which the response's offset wanders
    standstill: float = 0.0  # speed, position units per s, below which the direction fades
    speed: Array = field(default_factory=lambda: np.zeros(0))  # smoothed, for what is not linear in it
    direction: Array = field(default_factory=lambda: np.zeros(0))
    since: Array = field(default_factory=lambda: np.zeros(0))

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

    @property
    def resolved(self) -> float:
        """Travel, position units, below which what happens after a reversal is the sensor's."""
        return RESOLVED * float(np.sqrt(12.0)) * position_noise(self.x, self.file)

    @property
    def step(self) -> int:
        """Full-rate rows per fitted row."""
        return int(self.rows[1] - self.rows[0]) if len(self.rows) > 1 else 1

    def at(self, full: Array) -> Array:
        """A full-rate column (n,) or columns (n, k) through the filter, on the fitted rows."""
        return np.asarray(smooth(full, self.segment, self.sigma)[self.rows])

    def rate(self, full: Array) -> Array:
        """Central difference per second within segments."""
        return self._pieces(full, lambda x: np.gradient(x, self.period_s))

    def second(self, full: Array) -> Array:
        """Second difference per second squared within segments."""

        def one(x: Array) -> Array:
            out = np.zeros_like(x)
            out[1:-1] = (x[2:] - 2 * x[1:-1] + x[:-2]) / self.period_s**2
            return out

        return self._pieces(full, one)

    def delayed(self, full: Array, delay_s: float) -> Array:
        """What the column would have shown, had it not been late by `delay_s`."""
        if delay_s == 0.0:
            return full

        def one(x: Array) -> Array:
            k = np.arange(len(x)) + delay_s / self.period_s
            return np.asarray(np.interp(k, np.arange(len(x)), x))

        return self._pieces(full, one)

    def _pieces(self, full: Array, what: object) -> Array:
        out = np.zeros(len(full))
        for a, b in pieces(self.segment):
            if b - a > 2:
                out[a:b] = what(full[a:b])  # type: ignore[operator]
        return out


def pieces(label: NDArray[np.int64]) -> list[tuple[int, int]]:
    """Begin and end of every stretch of equal labels."""
    edges = np.flatnonzero(np.diff(label)) + 1
    marks = [0, *edges.tolist(), len(label)]
    return list(itertools.pairwise(marks)) if len(label) else []


def smooth(full: Array, segment: NDArray[np.int64], sigma: float) -> Array:
    """Gaussian low pass of standard deviation `sigma` rows within segments; 0: as it is."""
    if sigma <= 0:
        return full
    out = np.empty_like(full, dtype=float)
    for a, b in pieces(segment):
        out[a:b] = gaussian_filter1d(full[a:b], sigma, axis=0, mode="nearest", truncate=4.0)
    return out


def view_of(records: list[Record], rig: Rig, response: Response) -> View:
    """All records on one grid; the filter from the rig file or from the position's noise."""
    period = float(np.median([r.period_s for r in records]))
    parts = [_regular(r, period) for r in records]
    file = np.concatenate([np.full(len(p["t"]), k) for k, p in enumerate(parts)]).astype(np.int64)
    columns = {k: np.concatenate([p[k] for p in parts]) for k in parts[0]}
    t, ok, gap = columns.pop("t"), columns.pop("ok") > 0, columns.pop("gap") > 0
    label = columns.pop("run", np.zeros(len(t)))
    starts = np.array([r.start_s or 0.0 for r in records])
    fresh = np.concatenate([[True], (np.diff(file) != 0) | (gap[1:] & ~gap[:-1]) | (~gap[1:] & gap[:-1])])
    segment = np.cumsum(fresh)
    dynamic = response.is_force and (
        "inertia" in (*rig.estimate, *rig.constants) or response.channel == "acceleration"
    )
    sigma = _sigma(columns["position"], file, period, rig, dynamic)
    view = View(
        rig,
        response,
        period,
        sigma if dynamic else 0.0,
        t,
        t + starts[file],
        file,
        segment,
        file,
        columns,
        ok & ~gap,
        np.zeros(0, dtype=np.int64),
        dynamic,
        rig.turn or units_per_turn(rig.columns["position"].unit),
    )
    _motion(view, sigma)
    view.run = _runs(view, label)
    _choose_rows(view)
    return view


def _regular(record: Record, period: float) -> dict[str, Array]:
    """One record on a regular grid; rows in a gap, and near longer stretches without numbers, are not ok."""
    t = record.columns["t"]
    grid: Array = np.arange(int(np.floor((t[-1] - t[0]) / period)) + 1) * np.float64(period)
    out = {"t": grid}
    right = np.clip(np.searchsorted(t, grid), 1, len(t) - 1)
    wide = t[right] - t[right - 1] > GAP * max(period, record.period_s)
    inside = np.minimum(np.abs(t[right] - grid), np.abs(t[right - 1] - grid)) > 0.51 * period
    out["gap"] = (wide & inside).astype(float)
    nearest = np.clip(np.rint(np.interp(grid, t, np.arange(len(t)))).astype(int), 0, len(t) - 1)
    good_rows = np.ones(len(grid), dtype=bool)
    for name, x in record.columns.items():
        if name == "t":
            continue
        if name == "run":
            out["run"] = x[nearest]
            continue
        good = np.isfinite(x)
        out[name] = np.interp(grid, t[good], x[good])
        for a, b in pieces((~good).astype(np.int64)):
            if not good[a] and b - a > SHORT:
                good_rows &= ~((grid >= t[a]) & (grid <= t[b - 1]))
    out["ok"] = good_rows.astype(float)
    return out


def _sigma(x: Array, file: NDArray[np.int64], period: float, rig: Rig, dynamic: bool) -> float:
    """Rows: wide enough for the position's noise to be a small part of the acceleration."""
    if rig.smooth_s is not None:
        return rig.smooth_s / WINDOW / period
    noise = position_noise(x, file)
    sigma = LEAST
    while sigma < MOST:
        a = np.concatenate([np.diff(gaussian_filter1d(x[i:j], sigma), 2) for i, j in pieces(file)])
        size = float(np.sqrt(np.mean(np.clip(a, *np.quantile(a, [0.005, 0.995])) ** 2)))
        if noise * np.sqrt(3 / (8 * np.sqrt(np.pi)) / sigma**5) < NOISE * size:
            break
        sigma *= 1.25
    return sigma if dynamic else max(sigma, 4.0)


def acceleration(view: View) -> Array:
    """Full-rate acceleration (n,), smoothed until the position's noise is a small part of it."""
    width = _sigma(view.x, view.file, view.period_s, view.rig, True)
    return smooth(view.second(view.x), view.segment, width)


def position_noise(x: Array, file: NDArray[np.int64]) -> float:
    """rms of the position's white noise, from its fourth differences, and of its rounding."""
    fourth = np.diff(x, 4)[np.convolve(np.diff(file) != 0, np.ones(4), "valid")[: len(x) - 4] == 0]
    noise = 1.4826 * float(np.median(np.abs(fourth))) / np.sqrt(70.0)  # of white noise: 1+16+36+16+1
    step = quantum(x)
    if step is None:
        steps = np.abs(np.diff(x))
        steps = steps[steps > 1e-9 * (float(np.ptp(x)) or 1.0)]  # rows between two samples round differently
        step = float(np.quantile(steps, 0.02)) if len(steps) else 0.0
    return float(max(noise, step / np.sqrt(12.0)))


def least_travel(x: Array) -> float:
    """Travel that counts as motion: above the position's noise, and a ten-thousandth of the range."""
    reach = float(np.quantile(x, 0.99) - np.quantile(x, 0.01))
    second = x[2:] - 2 * x[1:-1] + x[:-2]
    return max(1e-4 * reach, 12 * float(np.median(np.abs(second))))


def _motion(view: View, sigma: float) -> None:
    """Speed, direction and travel since the last reversal."""
    soft = smooth(view.x, view.segment, max(sigma / 2, 1.0))
    view.speed = view.rate(soft)
    view.direction = direction_of(soft, view.file, least_travel(soft))
    view.since = since_reversal(soft, view.direction, view.file)
    if view.dynamic:  # a driven axis also stands still: there its friction has no direction
        fade(view, STANDSTILLS[3])
        width = max(sigma / 2, 1.0)
        noise = position_noise(view.x, view.file) / view.period_s / np.sqrt(4 * np.sqrt(np.pi) * width**3)
        top = float(np.quantile(np.abs(view.speed[view.ok]), 0.95)) if view.ok.any() else 0.0
        view.slow = max(SURE * noise, SLOWEST * top)


def fade(view: View, part: float) -> None:
    """Let the direction fade below `part` of the usual top speed."""
    top = float(np.quantile(np.abs(view.speed[view.ok]), 0.95)) if view.ok.any() else 0.0
    view.standstill = part * top
    view.direction = np.tanh(view.speed / (view.standstill or 1.0))


def _runs(view: View, label: Array) -> NDArray[np.int64]:
    by = view.rig.runs.get("by")
    if by == "turning_points":
        least = float(view.rig.runs.get("minimum_travel", 0.0))
        return np.asarray(np.cumsum(turning_points(view.x, view.file, least)), dtype=np.int64)
    if by == "column":
        change = np.concatenate([[False], (np.diff(label) != 0) | (np.diff(view.file) != 0)])
        return np.asarray(np.cumsum(change), dtype=np.int64)
    return view.file


def _choose_rows(view: View) -> None:
    """Rows that are fitted: one per filter width, and no more than can be fitted in time."""
    period = view.rig.analyse_period_s
    step = round(period / view.period_s) if period else round(view.sigma)
    most = MOST_ROWS if view.response.is_force else SENSOR_ROWS
    step = max(step, 1, int(np.ceil(len(view.t) / most)) if not period else 1)
    if view.sigma == 0 and step > 1 and not period:
        view.sigma = step / 2
    view.rows = np.concatenate([np.arange(a, b, step) for a, b in pieces(view.file)])
    margin = int(np.ceil(REACH * view.sigma)) + (1 if view.dynamic else 0)
    edge = np.zeros(len(view.t), dtype=bool)
    for a, b in pieces(view.segment):
        edge[a : a + margin] = True
        edge[max(b - margin, a) : b] = True
    # the filter carries what stands in for bad rows over to their neighbours
    if view.dynamic and not view.ok.all():
        edge |= maximum_filter1d(~view.ok, 2 * margin + 1)
    view.ok &= ~edge
