"""What one run of one axis leaves behind: the columns of the axis log, as arrays."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenarios.studies.paper.scales import ADC_A_PER_COUNT, COUNT_RATE, LOG_PERIOD_S

Array = NDArray[np.float64]


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
        first = round(seconds / LOG_PERIOD_S)
        if first >= self.t_s.size:
            raise ValueError(
                f"a run of {self.t_s.size * LOG_PERIOD_S:.2f} s has nothing after {seconds:.2f} s"
            )
        return Log(*(column[first:] for column in self._columns()))

    def last(self, seconds: float) -> "Log":
        """Return the last `seconds` of the log."""
        return self.after(max(0.0, self.t_s.size * LOG_PERIOD_S - seconds))

    def _columns(self) -> tuple[Array, ...]:
        return self.t_s, self.counts, self.effort, self.adc_a, self.adc_b, self.true_rate


def join(logs: list[Log]) -> Log:
    """Return consecutive logs of one bench as one."""
    if not logs:
        raise ValueError("no logs to join")
    return Log(*(np.concatenate(columns) for columns in zip(*(log._columns() for log in logs), strict=True)))
