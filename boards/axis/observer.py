"""A state observer in place of the PI near the tracking rate, which the paper's firmware does not have.

At a high preload friction falls while the axis gets faster, which a PI on counts cannot hold. An observer
with feedback of its states can: it knows axis, trains, bristles and motors (`plant/observer.py`). It was made
for one rate. As four sections of second order in parallel it needs no matrices. Their inputs are the effort
that went out and the angle that the axis is off; their outputs add up to the next effort.

While the PI drives, the sections follow its effort with no angle owed, so they take over without a bump. The
axis stands still then: one that leaps is not caught. From there the rate changes slowly, as bristles that
load at once leap.

Widths: states and the angle are 32 bits, products 64. Coefficients of sections and effort are Q28, those of
the angle Q24.
"""

from typing import Final

from boards.axis.pi import IncrementalPi
from boards.core.widths import INT32_TOP, saturate
from bus.protocol import OBSERVER_CELLS
from bus.protocol.scales import TICKS_PER_S, rate_q16

SECTIONS: Final = 4
PER_SECTION: Final = 6
"""trace, determinant; of the effort and of the angle the numerator's two. Behind all of them stands one that
goes straight from the angle to the effort."""
EFFORT_SHIFT: Final = 28
ANGLE_SHIFT: Final = 24
SLOWEST_Q16: Final = rate_q16(5.0)
FASTEST_Q16: Final = rate_q16(25.0)
"""Between them it drives. Friction was linearised at 15 arcsec/s; guiding at half of that stays within.
ASSUMPTION."""
STILL_TICKS: Final = 100
"""The axis stands: half a second within a count. ASSUMPTION."""
RAMP_Q16: Final = rate_q16(3.0) // TICKS_PER_S
"""Change of the rate in a tick: five seconds to the tracking rate. ASSUMPTION."""
TRIM_SHIFT: Final = 4
TRIM_Q16: Final = rate_q16(4.0)
"""The position loop's correction, made for a PI, is a sixteenth here, 4 arcsec/s at most. ASSUMPTION."""
OWED_Q16: Final = rate_q16(20.0 * TICKS_PER_S)
"""Angle owed, 20 arcsec, at which the axis is not held. The PI stops it, and all begins anew. ASSUMPTION."""
_ONE: Final = 1 << EFFORT_SHIFT
_GAIN_SHIFT: Final = 14
_GAIN_ERROR: Final = (1 << _GAIN_SHIFT) // 100


class Observer:
    """coefficients: of the sections one after the other. driving: the last effort was its own."""

    def __init__(self) -> None:
        self.coefficients = [0] * OBSERVER_CELLS
        self.on = 0
        self.start()

    def start(self) -> None:
        """Nothing is owed, and no effort went out."""
        self._states = [0] * (2 * SECTIONS)
        self._owed_q16 = self._rate_q16 = self._wanted_q16 = self._still = 0
        self.driving = False

    def switch(self, on: int) -> None:
        """On only with coefficients that can be an observer's."""
        self.on = int(on and self.sound())
        self.start()

    def sound(self) -> bool:
        """Whether every section is stable (Jury), and an effort that holds the axis is kept: gain of one."""
        gain = 0
        for at in range(0, SECTIONS * PER_SECTION, PER_SECTION):
            trace, determinant, first, second = self.coefficients[at : at + 4]
            if not (determinant < _ONE and abs(trace) < _ONE + determinant):
                return False
            gain += (first + second << _GAIN_SHIFT) // (_ONE - trace + determinant)
        return abs(gain - (1 << _GAIN_SHIFT)) <= _GAIN_ERROR

    def aim(self, steady: tuple[int, int], setpoint_q16: int, velocity: int) -> int:
        """The PI's set point at a tick. It is 0 until the axis stands still and the observer takes over.

        steady: a rate that is to be held, 0: none, and the position loop's correction of it. setpoint_q16:
        the PI's without an observer.
        """
        rate, correction = steady
        self._still = min(self._still + 1, STILL_TICKS) if -1 <= velocity <= 1 else 0
        if not SLOWEST_Q16 < abs(rate) < FASTEST_Q16:
            self.driving = False
            return setpoint_q16
        self._wanted_q16 = rate + saturate(correction >> TRIM_SHIFT, TRIM_Q16)
        if not self.driving and self._still == STILL_TICKS:
            self.driving = True
            self._rate_q16 = self._owed_q16 = 0
        return setpoint_q16 if self.driving else 0

    def step(self, pi: IncrementalPi, velocity: int) -> int:
        """Behind the PI's step; returns the effort in PWM steps."""
        c, states = self.coefficients, self._states
        if self.driving:
            self._rate_q16 += saturate(self._wanted_q16 - self._rate_q16, RAMP_Q16)
            self._owed_q16 = saturate(self._owed_q16 + (velocity << 16) - self._rate_q16, OWED_Q16)
            self.driving = abs(self._owed_q16) < OWED_Q16
        if self.driving:
            pi.replace(sum(states[::2]) + (c[-1] * self._owed_q16 >> ANGLE_SHIFT))
        else:
            self._owed_q16 = 0
        effort, owed = pi.effort_q16, self._owed_q16
        for section in range(SECTIONS):
            at, place = PER_SECTION * section, 2 * section
            first, second = states[place], states[place + 1]
            states[place] = saturate(
                (c[at] * first + c[at + 2] * effort >> EFFORT_SHIFT)
                + second
                + (c[at + 4] * owed >> ANGLE_SHIFT),
                INT32_TOP,
            )
            states[place + 1] = saturate(
                (c[at + 3] * effort - c[at + 1] * first >> EFFORT_SHIFT) + (c[at + 5] * owed >> ANGLE_SHIFT),
                INT32_TOP,
            )
        return pi.steps
