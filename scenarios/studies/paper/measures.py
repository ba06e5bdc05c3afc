"""What one run of one axis leaves behind, and figures taken from its velocity, as the paper states them.

The paper gives "peak errors" without saying over which average. Every figure is therefore computed for a
record the caller chooses: velocity as logged (counts of 5 ms), true velocity, or means of one second.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenarios.studies.paper.scales import ADC_A_PER_COUNT, COUNT_RATE, LOG_PERIOD_S
from scenarios.studies.paper.scales import Array as Array


@dataclass(frozen=True)
class Log:
    """Samples every 10 ms, all arrays of shape (n,).

    t_s: s since the bench was switched on. counts: incremental encoder, counts in the last 5 ms. effort:
    1/3000 of the supply, signed. adc_a, adc_b: ADC counts. true_rate: arcsec/s, what no instrument of the
    telescope saw.
    """

    t_s: Array
    counts: Array
    effort: Array
    adc_a: Array
    adc_b: Array
    true_rate: Array

    @property
    def rate(self) -> Array:
        """Velocity as logged, arcsec/s: multiples of 2.296."""
        return self.counts * COUNT_RATE

    @property
    def current_a(self) -> Array:
        """Current of motor A, A."""
        return self.adc_a * ADC_A_PER_COUNT

    @property
    def current_b(self) -> Array:
        """Current of motor B, A."""
        return self.adc_b * ADC_A_PER_COUNT

    def after(self, seconds: float) -> "Log":
        """Return the log without its first `seconds`: start-up discarded."""
        first, span_s = round(seconds / LOG_PERIOD_S), self.t_s.size * LOG_PERIOD_S
        if first >= self.t_s.size:
            raise ValueError(f"a run of {span_s:.2f} s has nothing after {seconds:.2f} s")
        return Log(*(column[first:] for column in self._columns()))

    def last(self, seconds: float) -> "Log":
        """Return the last `seconds` of the log."""
        return self.after(max(0.0, self.t_s.size * LOG_PERIOD_S - seconds))

    def _columns(self) -> tuple[Array, ...]:
        return self.t_s, self.counts, self.effort, self.adc_a, self.adc_b, self.true_rate


def join(logs: list[Log]) -> Log:
    """Return consecutive logs of one bench as one."""
    return Log(*(np.concatenate(columns) for columns in zip(*(log._columns() for log in logs), strict=True)))


def peak_percent(rate: Array, setpoint: float) -> float:
    """Return the largest deviation from `setpoint`, percent of it. Both in arcsec/s."""
    return float(np.max(np.abs(rate - setpoint)) / abs(setpoint) * 100.0)


def means(rate: Array) -> Array:
    """Return means over consecutive seconds; an incomplete last one is left out."""
    width = round(1.0 / LOG_PERIOD_S)
    count = rate.size // width
    if not count:
        raise ValueError(f"{rate.size} samples are fewer than one window of 1.0 s")
    return np.asarray(rate[: count * width].reshape(count, width).mean(axis=1), dtype=np.float64)


def cycles(rate: Array, setpoint: float) -> int:
    """Return how often the velocity went from below half a set point to above one and a half.

    A limit cycle does so again and again; quantisation of steady motion (7 to 8 % at 15 arcsec/s) never.
    """
    return rises(rate / setpoint < 0.5, rate / setpoint > 1.5)


def rises(low: NDArray[np.bool_], high: NDArray[np.bool_]) -> int:
    """Return how often a record went from low to high, whatever lies between."""
    marks = np.where(high, 1, np.where(low, -1, 0))
    return int(np.count_nonzero(np.diff(marks[marks != 0]) > 0))


@dataclass(frozen=True)
class Line:
    """A spectral line: frequency, Hz, and amplitude, in the unit of the record."""

    frequency_hz: float
    amplitude: float


def strongest_line(record: Array, low_hz: float, high_hz: float) -> Line:
    """Return the strongest sinusoid of `record` between two frequencies.

    Strongest is the one that explains most of what an offset and a trend leave. Its amplitude alone would
    favour slow sinusoids that offset and trend cancel again. Frequencies are tried on a grid of a tenth of
    the record's resolution. Raises ValueError when not one period of `high_hz` fits.
    """
    span = record.size * LOG_PERIOD_S
    if span * high_hz < 1.0:
        raise ValueError(f"a record of {span:.1f} s cannot show lines below {high_hz} Hz")
    # decimate: lines far below the sampling rate need no 10 ms samples
    width = max(1, int(0.05 / (high_hz * LOG_PERIOD_S)))
    count = record.size // width
    y = record[: count * width].reshape(count, width).mean(axis=1)
    t = (np.arange(count) * width + (width - 1) / 2.0) * LOG_PERIOD_S
    t = t - t.mean()
    rest = _detrended(t, y)
    best, least = Line(low_hz, 0.0), np.inf
    for f in np.arange(low_hz, high_hz, 0.1 / span):
        amplitude, left = _sinusoid(t, rest, f)
        if left < least:
            best, least = Line(float(f), amplitude), left
    return best


def line_amplitude(record: Array, frequency_hz: float) -> float:
    """Return the amplitude of the sinusoid of one frequency in `record`, in its unit."""
    t: Array = (np.arange(record.size, dtype=np.float64) - (record.size - 1) / 2.0) * LOG_PERIOD_S
    return _sinusoid(t, _detrended(t, record), frequency_hz)[0]


def _detrended(t: Array, y: Array) -> Array:
    return np.asarray(y - np.polyval(np.polyfit(t, y, 1), t), dtype=np.float64)


def _sinusoid(t: Array, rest: Array, frequency_hz: float) -> tuple[float, float]:
    """Amplitude of the sinusoid of one frequency that fits best, and the square sum that it leaves."""
    turn = 2 * np.pi * frequency_hz * t
    swing = np.column_stack([np.cos(turn), np.sin(turn)])
    found = np.linalg.lstsq(swing, rest, rcond=None)[0]
    return float(np.hypot(*found)), float(np.sum((rest - swing @ found) ** 2))


def stalled(rate: Array) -> bool:
    """Whether the axis stood still during any whole second of the record (arcsec/s)."""
    return bool(np.min(np.abs(means(rate))) < 1.0)
