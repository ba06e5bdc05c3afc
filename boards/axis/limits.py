"""Soft limits: stop in time, and only what leads further out."""

from typing import Final

from boards.axis.motion import POINTING, Motion
from boards.axis.profile import UNIT_SHIFT, UNITS_PER_STEP
from boards.core.widths import INT64_TOP
from bus.protocol import AxisMode, PositionFlag

_REACTION_TICKS: Final = 30
"""Until the velocity loop follows the braking set point, 150 ms. ASSUMPTION: its settling time."""
_COUNTS_TOP: Final = INT64_TOP >> (UNIT_SHIFT - 16)
"""Q16 counts whose Q18 still fits 64 bits; only the least acceleration with the greatest speed gets there."""
_LOW, _HIGH = int(PositionFlag.LIMIT_LOW), int(PositionFlag.LIMIT_HIGH)


class SoftLimits:
    """Looks at position and speed every 10 ms."""

    def __init__(self, motion: Motion) -> None:
        self._motion = motion
        self.reached = False

    def _braking_steps(self, velocity: int) -> int:
        """Steps the axis needs to stop from `velocity` counts/5 ms."""
        counts_q16 = (velocity << 16) * (velocity << 16) // (2 * self._motion.acceleration)
        counts_q16 += abs(velocity) * _REACTION_TICKS << 16
        return (min(counts_q16, _COUNTS_TOP) << (UNIT_SHIFT - 16)) // UNITS_PER_STEP

    def hit(self, velocity: int) -> bool:
        """True when the axis has to stop now."""
        motion = self._motion
        position = motion.position
        ends = motion.ends  # the encoder board has limits of its own, and is beyond one
        setpoint = motion.setpoint_q16  # with it, as at rest a count of either sign comes now and then
        braking = 0 if motion.mode in POINTING else self._braking_steps(velocity)
        outward = False
        if velocity > 0:
            outward = position + braking >= motion.high or (setpoint >= 0 and ends & _HIGH != 0)
        elif velocity < 0:
            outward = position - braking <= motion.low or (setpoint <= 0 and ends & _LOW != 0)
        self.reached = outward or ends != 0 or not self.inside(position)
        return outward and motion.mode not in (AxisMode.OFF, AxisMode.STOP)

    def inside(self, steps: int) -> bool:
        """Whether a target may be gone to."""
        return self._motion.low <= steps <= self._motion.high
