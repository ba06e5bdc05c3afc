"""The incremental PI of the paper (section 4) in fixed point, and the duty of the motor that lags.

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
        self.start(0, 0, 0)

    def start(self, effort: int, setpoint_q16: int, velocity: int) -> None:
        """Take over at `effort` (PWM steps) without a bump."""
        self.replace(effort << RATE_SHIFT)
        self._error = saturate(setpoint_q16 - (velocity << RATE_SHIFT), INT32_TOP)

    def step(self, setpoint_q16: int, velocity: int) -> int:
        """Effort in PWM steps for a set point (Q16 counts/5 ms) and the counts of the last 5 ms."""
        error = saturate(setpoint_q16 - (velocity << RATE_SHIFT), INT32_TOP)
        change = saturate(error - self._error, INT32_TOP)
        self.replace(self.effort_q16 + ((self.kp_q12 * change + self.ki_q12 * error) >> GAIN_SHIFT))
        self._error = error
        return self.steps

    def replace(self, effort_q16: int) -> None:
        """Another effort instead, from which the next tick goes on."""
        self.effort_q16 = saturate(effort_q16, self._limit)

    @property
    def steps(self) -> int:
        """The effort in whole PWM steps."""
        return (self.effort_q16 + _HALF) >> RATE_SHIFT


_PERCENT: Final = 100
SHARE_SHIFT: Final = 5
"""Time constant of the finer share, 2**5 ticks: 160 ms. A share that follows at once swings with the loop at
3 to 8 Hz, where wind pushes. Chosen on wind of 3 and 10 N m among 2**3, 2**5, 2**7 (`objective`)."""


class CounterTorque:
    """Duty register of the lagging motor: a share of the effort, in whole PWM steps (paper, section 3.3).

    Rounded anew at every tick, the register would move with the effort itself. Where the lagging motor
    conducts, every tenth step of the effort at 10 % would raise both duties and change no torque. A loop that
    rests there has a dead band. So the register stays until it is a whole step off. The effort does not
    follow when it moves: below the drop of a freewheel diode it changes nothing. ASSUMPTION: the paper gives
    the share and not its rounding.

    split: the share, percent. register: PWM steps. fade: speed, counts/5 ms, at which the share has fallen to
    nothing; 0: never.
    """

    def __init__(self, split: int, fade: int) -> None:
        self.split = split
        self.fade = fade
        self.start()

    def start(self) -> None:
        """No share yet."""
        self.register = 0
        self._share_q16 = 0

    def follow(self, effort: int, velocity: int) -> None:
        """Move the register for an effort (PWM steps)."""
        share = self._faded(abs(effort) * self.split, velocity)
        if not -_PERCENT < share - self.register * _PERCENT < _PERCENT:
            self.register = (share + _PERCENT // 2) // _PERCENT

    def share_q16(self, effort_q16: int, velocity: int) -> int:
        """The same share without whole steps, of a size in Q16, smoothed over `SHARE_SHIFT`. In one tick more
        effort is never less torque."""
        share = self._faded(effort_q16 * self.split // _PERCENT, velocity)
        self._share_q16 += (share - self._share_q16) >> SHARE_SHIFT
        return self._share_q16

    def _faded(self, share: int, velocity: int) -> int:
        fade = self.fade
        return share * max(0, fade - abs(velocity)) // fade if fade else share
