"""The incremental PI of the paper (section 4) in fixed point.

Gains in Q12, errors in Q16, the effort in Q16 PWM steps. With Ki = 0.037 plain integers would truncate
the integral action to nothing (hardware.md 1.4). The effort is limited where it is accumulated, before
the PWM register, so it cannot wind up. A change of set point enters through the difference of errors only, so
it is bumpless.

Widths: errors, their differences and the effort are 32 bit and saturate; gain times error is 64 bit (at most
2^20 x 2^31, twice).
"""

from typing import Final

from boards.core.widths import INT32_TOP, saturate

GAIN_SHIFT: Final = 12
RATE_SHIFT: Final = 16
_HALF: Final = 1 << (RATE_SHIFT - 1)


class IncrementalPi:
    """kp_q12: PWM steps per count/5 ms. ki_q12: PWM steps per count. limit: largest effort, PWM steps."""

    def __init__(self, kp_q12: int, ki_q12: int, limit: int) -> None:
        self.kp_q12 = kp_q12
        self.ki_q12 = ki_q12
        self._limit = min(limit << RATE_SHIFT, INT32_TOP)
        self._error = 0
        self.effort_q16 = 0

    def start(self, effort: int, setpoint_q16: int, velocity: int) -> None:
        """Take over at `effort` (PWM steps) without a bump."""
        self.effort_q16 = saturate(effort << RATE_SHIFT, self._limit)
        self._error = saturate(setpoint_q16 - (velocity << RATE_SHIFT), INT32_TOP)

    def step(self, setpoint_q16: int, velocity: int) -> int:
        """Effort in PWM steps for a set point (Q16 counts/5 ms) and the counts of the last 5 ms."""
        error = setpoint_q16 - (velocity << 16)
        if not -INT32_TOP <= error <= INT32_TOP:
            error = saturate(error, INT32_TOP)
        change = error - self._error
        if not -INT32_TOP <= change <= INT32_TOP:
            change = saturate(change, INT32_TOP)
        effort = self.effort_q16 + ((self.kp_q12 * change + self.ki_q12 * error) >> 12)
        limit = self._limit
        if effort > limit:
            effort = limit
        elif effort < -limit:
            effort = -limit
        self._error = error
        self.effort_q16 = effort
        return (effort + _HALF) >> 16
