"""What the paper's firmware does not have: a locked rate, a position from both encoders, a sense of wind.

RATE and CLASS close a loop around the velocity alone, so a torque that comes and goes every few seconds
leaves its mark. The lock sums the velocity error up and returns it as a correction of the set point.
The absolute encoder errs within each of its lines, by up to a few tenths of an arcsec. At the tracking rate
the error comes every 2.6 s, and the position loop follows. The blend takes what is faster than its time
constant from the incremental encoder, which was sampled in the same tick. It takes only the slow rest from
the absolute encoder.

Widths: the lock's sum is 32 bits, limited to 2 arcsec in a 64-bit register before it is stored. Its product
with the gain and the blend's position are 64 bits.
"""

from typing import Final

from boards.axis.profile import UNIT_SHIFT
from boards.core.widths import saturate
from bus.protocol.scales import COUNTS_PER_TURN
from bus.units import ARCSEC_PER_TURN

LOCK_LIMIT_Q16: Final = round(2.0 / ARCSEC_PER_TURN * COUNTS_PER_TURN) << 16
"""Largest position error the lock remembers, 2 arcsec. More is a set point that the axis cannot follow, and
would be paid back with a swing. ASSUMPTION."""


class RateLock:
    """gain_q16: correction per count of position error, counts/tick."""

    def __init__(self, gain_q16: int) -> None:
        self._gain_q16 = gain_q16
        self.start()

    def start(self) -> None:
        """Nothing is owed."""
        self._error_q16 = 0

    def step(self, setpoint_q16: int, velocity: int) -> int:
        """The correction, Q16 counts/tick; velocity: the counts of the last tick."""
        self._error_q16 = saturate(self._error_q16 + setpoint_q16 - (velocity << 16), LOCK_LIMIT_Q16)
        return self._error_q16 * self._gain_q16 >> 16


class Blend:
    """shift: time constant, 2**shift ticks.

    The position is kept, not a sum of counts, so nothing grows with the night. It has 64 bits and is never
    farther from the absolute encoder than 2**shift ticks of counts (2^15 ticks of 2^33: 2^48).
    """

    def __init__(self, shift: int) -> None:
        self.shift = shift
        self.start()

    def start(self) -> None:
        """The next position is the absolute encoder's: counts of the time between were not taken along."""
        self._begun = False

    def step(self, absolute_q18: int, velocity: int, creeping: bool) -> int:
        """Position, Q18 counts. Fast motion takes the absolute encoder's: the roller's ratio is not exact."""
        if not self._begun or not creeping:
            self._begun = True
            self._position_q18 = absolute_q18
            return absolute_q18
        position = self._position_q18 + (velocity << UNIT_SHIFT)
        self._position_q18 = position = position + (absolute_q18 - position >> self.shift)
        return position


_TOP_Q16: Final = 8 << 16
_FAST_SHIFT: Final = 2
_SLOW_SHIFT: Final = 4
_WINDOW_TICKS: Final = 1024
"""5.12 s: a start from rest shakes for three, so it is never loud in two windows one after the other."""
_LOUD: Final = 13107 * _WINDOW_TICKS
"""0.2 counts a tick, Q16. In still air default effects leave 0.09 at most; a wind of 0.3 N m leaves 0.37
(`low_preload_motor_units`)."""
_QUIET: Final = 9175 * _WINDOW_TICKS
"""0.14 counts: the other gains leave 0.26 of that wind, and of commutation ripple no more than this."""


class Gusts:
    """Notices that wind shakes the axis: then other gains hold it better (config.py, `kp_gust`).

    What wind leaves of the velocity error lies between 1 and 8 Hz, where gears and motors leave nothing at
    the tracking rate. Two low-passes cut that band out: 9 Hz and 2 Hz apart. Its mean size over five seconds
    tells. All is 32 bits wide: an error counts up to 8 counts a tick, so a window's sum stays below 2^31.

    blowing: whether the last two windows were loud; then, until two were quiet.
    """

    def __init__(self) -> None:
        self.start()

    def start(self) -> None:
        """The air stands still."""
        self._fast_q16 = self._slow_q16 = self._sum = self._ticks = 0
        self._turned = False
        self.blowing = False

    def step(self, error_q16: int) -> None:
        """Velocity error of a tick in which the axis creeps, Q16 counts."""
        self._fast_q16 += (saturate(error_q16, _TOP_Q16) - self._fast_q16) >> _FAST_SHIFT
        self._slow_q16 += (self._fast_q16 - self._slow_q16) >> _SLOW_SHIFT
        self._sum += abs(self._fast_q16 - self._slow_q16)
        self._ticks += 1
        if self._ticks == _WINDOW_TICKS:
            turned = self._sum < _QUIET if self.blowing else self._sum > _LOUD
            if turned and self._turned:
                self.blowing = not self.blowing
                turned = False
            self._turned = turned
            self._sum = self._ticks = 0
