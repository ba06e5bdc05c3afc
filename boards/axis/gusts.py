"""Notices that wind shakes the axis: then other gains hold it better (config.py, `kp_gust`).

What wind leaves of the velocity error lies between 1 and 8 Hz, where gears and motors leave nothing at the
tracking rate. Two low-passes cut that band out: 9 Hz and 2 Hz apart. Its mean size over five seconds tells.

Widths: all 32 bits. An error counts up to 8 counts a tick, so a window's sum stays below 2^31.
"""

from typing import Final

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
    """blowing: whether the last two windows were loud; then, until two were quiet."""

    def __init__(self) -> None:
        self.start()

    def start(self) -> None:
        """The air stands still."""
        self._fast_q16 = self._slow_q16 = self._sum = self._ticks = 0
        self._turned = False
        self.blowing = False

    def step(self, error_q16: int) -> None:
        """Velocity error of a tick in which the axis creeps, Q16 counts."""
        error = max(-_TOP_Q16, min(_TOP_Q16, error_q16))
        self._fast_q16 += (error - self._fast_q16) >> _FAST_SHIFT
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
