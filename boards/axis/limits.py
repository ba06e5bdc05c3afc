"""Soft limits: stop in time, and only what leads further out."""

from typing import Final

from boards.axis.motion import POINTING, Motion
from boards.axis.profile import UNIT_SHIFT, UNITS_PER_STEP
from boards.core.widths import INT64_TOP
from bus.protocol import AxisMode, PositionFlag

_REACTION_TICKS: Final = 30
"""Time in which the velocity loop begins to follow the braking set point, 150 ms. ASSUMPTION: its settling
time."""
_COUNTS_TOP: Final = INT64_TOP >> (UNIT_SHIFT - 16)
"""Q16 counts whose Q18 still fits 64 bits; only the slightest acceleration with the greatest speed gets
there."""


class SoftLimits:
    """Looks at position and speed every 10 ms."""

    def __init__(self, motion: Motion) -> None:
        self._motion = motion
        self.reached = False
        self._near_low = self._near_high = 0
        self.refresh()

    def refresh(self) -> None:
        """Work out the guards again after a limit, a rate or the acceleration has changed."""
        motion = self._motion
        top = max(motion.classes)
        distance = self._braking_steps(top >> 16) * 3  # 3: rates of up to sqrt(3) times slew are accepted
        self._near_low = motion.low + distance
        self._near_high = motion.high - distance

    def _braking_steps(self, velocity: int) -> int:
        """Steps the axis needs to stop from `velocity` counts/5 ms."""
        counts_q16 = (velocity << 16) * (velocity << 16) // (2 * self._motion.acceleration)
        counts_q16 += abs(velocity) * _REACTION_TICKS << 16
        return (min(counts_q16, _COUNTS_TOP) << (UNIT_SHIFT - 16)) // UNITS_PER_STEP

    def hit(self, velocity: int) -> bool:
        """True when the axis has to stop now."""
        motion = self._motion
        position = motion.position
        if self._near_low < position < self._near_high and not motion.ends:
            self.reached = False
            return False
        braking = 0 if motion.mode in POINTING else self._braking_steps(velocity)
        outward_high = velocity > 0 and position + braking >= motion.high
        outward_low = velocity < 0 and position - braking <= motion.low
        outside = position > motion.high or position < motion.low
        if motion.ends:  # the encoder board has limits of its own, and is beyond one
            setpoint = motion.setpoint_q16  # with it, as at rest a count of either sign comes now and then
            outward_high |= velocity > 0 <= setpoint and bool(motion.ends & PositionFlag.LIMIT_HIGH)
            outward_low |= velocity < 0 >= setpoint and bool(motion.ends & PositionFlag.LIMIT_LOW)
            outside = True
        self.reached = outward_high or outward_low or outside
        return (outward_high or outward_low) and motion.mode not in (AxisMode.OFF, AxisMode.STOP)

    def inside(self, steps: int) -> bool:
        """Whether a target may be gone to."""
        return self._motion.low <= steps <= self._motion.high
