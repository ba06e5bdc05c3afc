"""Effort that is known beforehand: waves over the position, and friction that turns at a reversal.

All are integers as a dsPIC has them. Phases are 32 bit and wrap, the sine is a table of 1024 values in flash,
products fit 64 bits. A shaft of the gear train turns with the axis while the teeth touch, so one angle, that
of the absolute encoder, serves every stage. Line k has its order in cycles per turn of the axis.
"""

from math import cos, pi, sin
from typing import Final

from bus.protocol import HARMONICS
from bus.protocol.scales import COUNTS_PER_TURN, STEPS_PER_TURN

_TABLE_BITS: Final = 10
_SIZE: Final = 1 << _TABLE_BITS
_MASK: Final = _SIZE - 1
_SHIFT: Final = 32 - _TABLE_BITS
_PART_BITS: Final = 12
"""Between two values of the table: slow waves would move in jumps of a tenth of a step otherwise."""
_PART_MASK: Final = (1 << _PART_BITS) - 1
_COS: Final = [round(32767 * cos(2 * pi * k / _SIZE)) for k in range(_SIZE + 1)]
_SIN: Final = [round(32767 * sin(2 * pi * k / _SIZE)) for k in range(_SIZE + 1)]
_LEAD_Q16: Final = round(1.5 * STEPS_PER_TURN / COUNTS_PER_TURN * 65536)
"""Steps per count, one and a half ticks. It is the mean age of a position frame and half the tick in which
the effort will be in force. A frame is up to one tick old: both boards run on their own crystals.
ASSUMPTION."""


class Compensator:
    """on: parameter 13. orders_q16, cosines_q8, sines_q8: the table, PWM steps."""

    def __init__(self) -> None:
        self.on = 0
        self.orders_q16 = [0] * HARMONICS
        self.cosines_q8 = [0] * HARMONICS
        self.sines_q8 = [0] * HARMONICS
        self._lines: list[tuple[int, int, int]] = []
        self.level_q8 = 0
        self.travel = 1
        self.start()

    def start(self) -> None:
        """The friction model begins unloaded."""
        self._friction_q16 = 0

    def refresh(self) -> None:
        """Keep the lines that do something."""
        rows = zip(self.orders_q16, self.cosines_q8, self.sines_q8, strict=True)
        self._lines = [row for row in rows if row[1] or row[2]]

    @property
    def lines(self) -> int:
        """Lines in use."""
        return len(self._lines)

    @property
    def level_q8(self) -> int:
        """Effort of sliding friction, PWM steps in Q8."""
        return self._level_q16 >> 8

    @level_q8.setter
    def level_q8(self, value: int) -> None:
        self._level_q16 = value << 8

    @property
    def travel(self) -> int:
        """Counts in which friction turns."""
        return self._travel

    @travel.setter
    def travel(self, counts: int) -> None:
        self._travel = counts
        self._reciprocal_q32 = (1 << 32) // counts

    def effort_q16(self, position: int, velocity: int, setpoint_q16: int) -> int:
        """PWM steps, Q16. position: steps, as last received; velocity: counts/tick; setpoint: counts/tick."""
        here = position + (velocity * _LEAD_Q16 >> 16)
        total = 0
        for order, a, b in self._lines:
            phase = here * order >> 13
            place = phase >> _SHIFT & _MASK
            part = phase >> _SHIFT - _PART_BITS & _PART_MASK
            cosine, sine = _COS[place], _SIN[place]
            cosine += (_COS[place + 1] - cosine) * part >> _PART_BITS
            sine += (_SIN[place + 1] - sine) * part >> _PART_BITS
            total += a * cosine + b * sine
        return (total >> 7) + self._friction(setpoint_q16)

    def _friction(self, setpoint_q16: int) -> int:
        """Dahl's model, driven by the reference: the force turns within `travel`, as the bristles do."""
        if not self._level_q16:
            return 0
        share_q16 = min(abs(setpoint_q16) * self._reciprocal_q32 >> 32, 65536)
        goal = self._level_q16 if setpoint_q16 >= 0 else -self._level_q16
        self._friction_q16 += (goal - self._friction_q16) * share_q16 >> 16
        return self._friction_q16
