"""Figures taken from a velocity record, the way the paper states them.

The paper gives "peak errors" without saying over which average. Every figure is therefore computed for a
record the caller chooses: velocity as logged (counts of 5 ms), true velocity, or means of one second.
"""

from dataclasses import dataclass

import numpy as np

from scenarios.paper.log import Array, Log
from scenarios.paper.scales import LOG_PERIOD_S


def peak_percent(rate: Array, setpoint: float) -> float:
    """Return the largest deviation from `setpoint`, percent of it. Both in arcsec/s."""
    return float(np.max(np.abs(rate - setpoint)) / abs(setpoint) * 100.0)


def rms_percent(rate: Array, setpoint: float) -> float:
    """Return the root mean square deviation from `setpoint`, percent of it."""
    return float(np.sqrt(np.mean((rate - setpoint) ** 2)) / abs(setpoint) * 100.0)


def means(rate: Array, seconds: float = 1.0) -> Array:
    """Return means over consecutive windows of `seconds`; an incomplete last window is left out."""
    width = round(seconds / LOG_PERIOD_S)
    count = rate.size // width
    if not count:
        raise ValueError(f"{rate.size} samples are fewer than one window of {seconds} s")
    return np.asarray(rate[: count * width].reshape(count, width).mean(axis=1), dtype=np.float64)


@dataclass(frozen=True)
class ThreeWays:
    """Peak deviation, percent of the set point: as logged (5 ms counts), true, and of means over one
    second."""

    logged: float
    true: float
    second: float

    def as_dict(self) -> dict[str, float]:
        """Return the three figures by name, rounded for printing."""
        return {
            "peak_5ms_percent": round(self.logged, 3),
            "peak_true_percent": round(self.true, 3),
            "peak_1s_percent": round(self.second, 3),
        }


def peaks(log: Log, setpoint: float) -> ThreeWays:
    """Return the peak deviation of a run from its set point (arcsec/s) in three ways."""
    return ThreeWays(
        peak_percent(log.rate, setpoint),
        peak_percent(log.true_rate, setpoint),
        peak_percent(means(log.true_rate), setpoint),
    )


def cycles(rate: Array, setpoint: float, depth: float = 0.5) -> int:
    """Return how often the velocity went from below to above: below (1 - depth) and then above (1 + depth)
    set points.

    A limit cycle does that again and again; quantisation of a steady motion (7 to 8 percent at 15 arcsec/s)
    never.
    """
    ratio = rate / setpoint
    state, count = 0, 0
    for low, high in zip(ratio < 1.0 - depth, ratio > 1.0 + depth, strict=True):
        if low:
            state = -1
        elif high:
            if state < 0:
                count += 1
            state = 1
    return count


@dataclass(frozen=True)
class Line:
    """A spectral line: frequency, Hz, and amplitude, in the unit of the record."""

    frequency_hz: float
    amplitude: float


def strongest_line(record: Array, low_hz: float, high_hz: float, period_s: float = LOG_PERIOD_S) -> Line:
    """Return the strongest sinusoid of `record` between two frequencies.

    Strongest is the one that explains most of what an offset and a trend leave: its amplitude alone would
    favour slow sinusoids that offset and trend cancel again. Frequencies are tried on a grid of a tenth of
    the record's resolution. Raises ValueError when not one period of `high_hz` fits.
    """
    span = record.size * period_s
    if span * high_hz < 1.0:
        raise ValueError(f"a record of {span:.1f} s cannot show lines below {high_hz} Hz")
    # decimate: lines far below the sampling rate need no 10 ms samples
    width = max(1, int(0.05 / (high_hz * period_s)))
    count = record.size // width
    y = record[: count * width].reshape(count, width).mean(axis=1)
    t = (np.arange(count) * width + (width - 1) / 2.0) * period_s
    t = t - t.mean()
    still = np.column_stack([np.ones_like(t), t / span])
    rest = y - still @ np.linalg.lstsq(still, y, rcond=None)[0]
    best, most = Line(low_hz, 0.0), -1.0
    for f in np.arange(low_hz, high_hz, 0.1 / span):
        swing = np.column_stack([np.cos(2 * np.pi * f * t), np.sin(2 * np.pi * f * t)])
        coefficient = np.linalg.lstsq(swing, rest, rcond=None)[0]
        explained = float(rest @ rest - np.sum((rest - swing @ coefficient) ** 2))
        if explained > most:
            best, most = Line(float(f), float(np.hypot(coefficient[0], coefficient[1]))), explained
    return best


def line_amplitude(record: Array, frequency_hz: float, period_s: float = LOG_PERIOD_S) -> float:
    """Return the amplitude of the sinusoid of one frequency in `record`, in its unit."""
    t = np.arange(record.size) * period_s
    t = t - t.mean()
    still = np.column_stack([np.ones_like(t), t])
    rest = record - still @ np.linalg.lstsq(still, record, rcond=None)[0]
    swing = np.column_stack([np.cos(2 * np.pi * frequency_hz * t), np.sin(2 * np.pi * frequency_hz * t)])
    coefficient = np.linalg.lstsq(swing, rest, rcond=None)[0]
    return float(np.hypot(coefficient[0], coefficient[1]))


def stalled(rate: Array) -> bool:
    """Whether the axis stood still during any whole second of the record (arcsec/s)."""
    return bool(np.min(np.abs(means(rate))) < 1.0)


@dataclass(frozen=True)
class Step:
    """A step response: 10-90 % rise time, s; overshoot, percent of the set point; mean and time of settled
    motion."""

    rise_s: float
    overshoot_percent: float
    settled: float


def step_response(t_s: Array, rate: Array, setpoint: float) -> Step:
    """Return what a step response is described by. The settled value is the mean of the last third."""
    t = t_s - t_s[0]
    above = rate >= 0.9 * setpoint
    if not above.any():
        return Step(float("inf"), 0.0, float(rate[-rate.size // 3 :].mean()))
    end = int(np.argmax(above))
    # the last time below 10 % before the first time above 90 %
    below = np.nonzero(rate[: end + 1] < 0.1 * setpoint)[0]
    start = int(below[-1]) if below.size else 0

    def crossing(k: int, level: float) -> float:
        """Time at which the straight line between sample k-1 and k passes `level`."""
        if k == 0 or rate[k] == rate[k - 1]:
            return float(t[k])
        share = (level - rate[k - 1]) / (rate[k] - rate[k - 1])
        return float(t[k - 1] + share * (t[k] - t[k - 1]))

    begin = crossing(min(start + 1, end), 0.1 * setpoint)
    return Step(
        crossing(end, 0.9 * setpoint) - begin,
        max(0.0, float(rate.max() / setpoint - 1.0) * 100.0),
        float(rate[-(rate.size // 3) :].mean()),
    )
