"""The LVDT with its carrier: excitation, secondary voltage, synchronous rectifier, low pass (P12).

`FocusPort.lvdt` gives the mean of the rectified signal at once. Here it is made of the 2 kHz it comes from.
It lags, ripples at 4 kHz and loses the cosine of the transducer's phase error. Carrier: paper. The rest is an
ASSUMPTION: a filter of 5 ms, two orders below the ripple and faster than the 50 ms of a FOCUS frame.
"""

from collections.abc import Callable
from math import exp, pi, sin

CARRIER_HZ = 2000.0
"""Paper, section 3.2 (P12)."""
FILTER_S = 5e-3
"""Time constant of each of the two first-order low passes behind the rectifier. ASSUMPTION."""
_PER_CARRIER = 40
"""Steps of the integration in one period of the carrier."""
_OVER_A_STEP = sin(pi / _PER_CARRIER) / (pi / _PER_CARRIER)
"""Mean of a sine over a step, by its value in the middle of it."""


class CarrierLvdt:
    """Pin `(t_ns) -> V` in place of a `FocusPort.lvdt`.

    ideal: that pin, the voltage a perfect rectifier would show now; middle: its voltage in the middle of the
    travel. phase_rad: of the secondary against the excitation. Looked at in rising times.
    """

    def __init__(
        self,
        ideal: Callable[[int], float],
        middle: float = 2.5,
        phase_rad: float = 0.0,
        filter_s: float = FILTER_S,
    ) -> None:
        self.ideal = ideal
        self.middle = middle
        self.phase_rad = phase_rad
        self.filter_s = filter_s
        self.now_ns = 0
        self.step_ns = round(1e9 / CARRIER_HZ / _PER_CARRIER)
        self.first = self.second = ideal(0) - middle
        self._keep = exp(-self.step_ns * 1e-9 / filter_s)

    def secondary(self, t_ns: int) -> float:
        """V at the transducer's output: the carrier, its size and sign by the position. A rectified sine of
        height pi/2 has mean 1."""
        size = (self.ideal(t_ns) - self.middle) * pi / 2
        return size * sin(2 * pi * CARRIER_HZ * t_ns * 1e-9 + self.phase_rad)

    def __call__(self, t_ns: int) -> float:
        """V at the ADC at `t_ns`."""
        if t_ns - self.now_ns > 2e10 * self.filter_s:  # twenty time constants: nothing of before is left
            self.now_ns = t_ns - round(2e10 * self.filter_s) // self.step_ns * self.step_ns
        while self.now_ns + self.step_ns <= t_ns:
            middle_ns = self.now_ns + self.step_ns // 2
            sign = 1.0 if sin(2 * pi * CARRIER_HZ * middle_ns * 1e-9) >= 0 else -1.0
            rectified = sign * self.secondary(middle_ns) * _OVER_A_STEP
            self.first += (rectified - self.first) * (1 - self._keep)
            self.second += (self.first - self.second) * (1 - self._keep)
            self.now_ns += self.step_ns
        return self.middle + self.second


def ripple(size: float, filter_s: float = FILTER_S) -> float:
    """Amplitude of the 4 kHz ripple, V, for a rectified mean of `size`. The second harmonic of |sin| is 2/3
    of its mean. Two first-order low passes take 1 / (1 + (w t)^2) of it."""
    reach = 2 * pi * 2 * CARRIER_HZ * filter_s
    return size * 2 / 3 / (1 + reach * reach)
