"""One run as the rest of the tool sees it: columns on the log's own clock, and what is known of each."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from calibration.arrays import Array
from calibration.inputs import thresholds as limits


@dataclass(frozen=True)
class Repair:
    """What was wrong with a column, at how many rows, how large (rig units), and what was done."""

    kind: str  # wrap, spike, repeat, saturation, signed, lost, leap, jitter, rounded
    channel: str
    rows: int
    size: float
    note: str


@dataclass(frozen=True)
class Signal:
    """A column as it was read, after scale and declared wrap: rig units."""

    channel: str
    column: str
    unit: str
    low: float
    high: float
    quantum: float | None  # smallest step; None when the column does not step
    missing: int  # rows without a number
    wraps: int  # of a declared counter


@dataclass
class Run:
    """One log file, or one section of it.

    `columns` of an axis hold SI units. Motion: `t` s, `position`/`aux` rad (unwrapped), `velocity` rad/s at
    the axis, `motor_a/b` rad/s at the motor, `setpoint` rad/s. Electrical: `effort` as a signed fraction of
    the supply, `current_a/b` A, `supply` V. Also `temperature` degree C. `columns` of a table hold the rig's
    units. `raw` keeps the columns as logged. `logged`: those that were put on another clock, before, in rig
    units: their steps are the sensor's. `start_s` is where `t` is 0 on the clock that all files share, of any
    epoch; None: not known. `in_order`: only the order of the files makes it so.
    """

    name: str
    path: Path
    session: str
    columns: dict[str, Array]
    raw: dict[str, Array] = field(default_factory=dict)
    header: dict[str, str] = field(default_factory=dict)
    scales: dict[str, float] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    signals: dict[str, Signal] = field(default_factory=dict)
    period_s: float = 0.0
    start_s: float | None = None
    in_order: bool = False
    repairs: list[Repair] = field(default_factory=list)
    logged: dict[str, Array] = field(default_factory=dict)

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.columns["t"])

    @property
    def duration_s(self) -> float:
        """Time from the first to the last row in s."""
        t = self.columns["t"]
        return float(t[-1] - t[0]) if len(t) > 1 else 0.0

    @property
    def gap_s(self) -> float:
        """A step of the clock in s beyond which rows are missing: longer than its own jitter makes it."""
        return longest_step(np.diff(self.columns["t"]), self.period_s)

    def among(self, names: Collection[str]) -> bool:
        """Whether `names` have this run, or its file."""
        return not {self.name, str(self.path), self.path.name, self.path.stem}.isdisjoint(names)

    def gaps(self) -> list[tuple[float, float]]:
        """Begin and end in s of every stretch without rows."""
        t = self.columns["t"]
        at = np.flatnonzero(np.diff(t) > self.gap_s)
        return [(float(t[k]), float(t[k + 1])) for k in at]


def longest_step(steps: Array, period_s: float) -> float:
    """The step (s) of a clock, of all its steps (n,), beyond which rows are missing and no stamp shakes."""
    usual = float(np.quantile(steps, limits.USUAL_STEPS)) if len(steps) >= limits.FEWEST_STEPS else 0.0
    return limits.GAP * max(period_s, min(usual, limits.SHAKEN * period_s))


def numbers(records: Iterable[Run], channel: str) -> Array:
    """All numbers of a channel, one record's after the other's; none where no record has it."""
    logged = (r.columns[channel] for r in records if channel in r.columns)
    return np.concatenate([np.zeros(0), *(x[np.isfinite(x)] for x in logged)])


def step_of(records: Iterable[Run], channel: str) -> float | None:
    """Smallest step of a channel over all records, as it was logged."""
    logged = (r.logged.get(channel, r.columns.get(channel, np.zeros(0))) for r in records)
    return quantum(np.concatenate([x[np.isfinite(x)] for x in logged]))


def rows_per_reading(records: Iterable[Run], channel: str) -> float:
    """Rows that a reading of a channel stands for, where it was put on another one's stamps; else 1."""
    counts = [(r.rows, len(r.logged[channel])) for r in records if channel in r.logged]
    return sum(rows for rows, _ in counts) / max(sum(own for _, own in counts), 1) if counts else 1.0


def signal_of(channel: str, column: str, unit: str, x: Array, wraps: int) -> Signal:
    """Range and quantum of a column."""
    good = x[np.isfinite(x)]
    low, high = (float(good.min()), float(good.max())) if len(good) else (np.nan, np.nan)
    return Signal(channel, column, unit, low, high, quantum(good), len(x) - len(good), wraps)


def quantum(x: Array) -> float | None:
    """Smallest step of a column of which all others are multiples; None when there is none.

    Decimal rounding in a text file is a quantum too: the column cannot say less.
    """
    values = np.unique(x)
    if len(values) < limits.FEWEST_VALUES:
        return None
    steps = np.diff(values)
    steps = steps[steps > limits.SAME_VALUE * max(float(np.abs(values).max()), 1e-300)]
    if len(steps) == 0:
        return None
    # a wide, sparse column has few steps of one count
    least = float(np.quantile(steps, limits.SMALL_STEPS)), float(steps.min())
    return _as_multiples(steps, least[0]) or _as_multiples(steps, least[1])


def last_digit(values: Array) -> float:
    """The power of ten of which all values are multiples; 0 where that is finer than any sensor."""
    whole = float(np.ptp(values)) or 1.0
    for digit in 10.0 ** np.arange(np.floor(np.log10(whole)), np.log10(limits.FINEST * whole), -1.0):
        if np.all(np.abs(values / digit - np.round(values / digit)) < limits.WHOLE):
            return float(digit)
    return 0.0


def _as_multiples(steps: Array, least: float) -> float | None:
    """About `least`, when the steps are multiples of it."""
    near = steps[(steps > 0.5 * least) & (steps < 1.5 * least)]
    q = float(np.median(near)) if len(near) else least
    multiple = steps / q
    small = multiple < limits.MOST_MULTIPLE  # beyond, q's own error adds up
    off = np.abs(multiple - np.round(multiple))[small]
    fits = off < limits.WHOLE_STEPS
    # how often so many would all be as whole by luck, the one that `q` is aside, among so many steps
    luck = (2 * float(off[fits].max(initial=0.0))) ** (small.sum() - 1) * len(steps)
    return q if luck < limits.LUCKY_COLUMN and np.mean(fits) >= limits.STEPS_SHARE else None
