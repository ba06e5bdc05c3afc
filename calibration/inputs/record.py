"""A record: one run of a drive as columns, and what is known of every column."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from calibration.readers.run import Array, Run

GAP = 2.5  # sample periods between two rows: a row is missing


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
class Record(Run):
    """A run with its clock: `t` from 0 in s, `start_s` on the clock that all files share (None: not known).

    `run_label` is the rig's own run number per row, if it has one.
    """

    signals: dict[str, Signal] = field(default_factory=dict)
    period_s: float = 0.0
    start_s: float | None = None
    repairs: list[Repair] = field(default_factory=list)

    def gaps(self) -> list[tuple[float, float]]:
        """Begin and end in s of every stretch without rows."""
        t = self.columns["t"]
        at = np.flatnonzero(np.diff(t) > GAP * self.period_s)
        return [(float(t[k]), float(t[k + 1])) for k in at]


def signal_of(channel: str, column: str, unit: str, x: Array, wraps: int) -> Signal:
    """Range and quantum of a column."""
    good = x[np.isfinite(x)]
    return Signal(
        channel,
        column,
        unit,
        float(good.min()) if len(good) else float("nan"),
        float(good.max()) if len(good) else float("nan"),
        quantum(good),
        int(len(x) - len(good)),
        wraps,
    )


STEPS = 0.995  # of all steps are whole multiples of a quantum
ROUNDING = 1e-3  # of a quantum: what a text file's digits leave


def quantum(x: Array) -> float | None:
    """Smallest step of a column of which all others are multiples; None when there is none.

    Decimal rounding in a text file is a quantum too: the column cannot say less.
    """
    values = np.unique(x)
    if len(values) < 3:
        return None
    steps = np.diff(values)
    steps = steps[steps > 1e-12 * max(float(np.abs(values).max()), 1e-300)]
    if len(steps) == 0:
        return None
    # a wide, sparse column has few steps of one count
    return _as_multiples(steps, float(np.quantile(steps, 0.02))) or _as_multiples(steps, float(steps.min()))


def _as_multiples(steps: Array, least: float) -> float | None:
    """About `least`, when the steps are multiples of it."""
    near = steps[(steps > 0.5 * least) & (steps < 1.5 * least)]
    q = float(np.median(near)) if len(near) else least
    multiple = steps / q
    small = multiple < 50  # beyond, q's own error adds up
    fits = np.abs(multiple - np.round(multiple)) < np.maximum(ROUNDING, 0.02)
    return q if small.sum() >= 2 and np.mean(fits[small]) >= STEPS else None
