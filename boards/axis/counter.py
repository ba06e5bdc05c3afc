"""Duty register of the lagging motor: a share of the effort, in whole PWM steps (paper, section 3.3).

Rounded anew at every tick, the register would move with the effort itself. Where the lagging motor conducts,
every tenth step of the effort at 10 % would raise both duties and change no torque. A loop that rests there
has a dead band. So the register stays until it is a whole step off. The effort does not follow when it moves:
below the drop of a freewheel diode it changes nothing. ASSUMPTION: the paper gives the share and not its
rounding.
"""

from typing import Final

_PERCENT: Final = 100
SHARE_SHIFT: Final = 5
"""Time constant of the finer share, 2**5 ticks: 160 ms. A share that follows at once swings with the loop at
3 to 8 Hz, where wind pushes. Chosen on wind of 3 and 10 N m among 2**3, 2**5, 2**7 (`objective`)."""


class CounterTorque:
    """split: share of the effort, percent. register: PWM steps. fade: speed, counts/5 ms, at which the share
    has fallen to nothing; 0: never."""

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
        size = effort if effort >= 0 else -effort
        share = size * self.split
        fade = self.fade
        if fade:
            share = share * max(0, fade - abs(velocity)) // fade
        if not -_PERCENT < share - self.register * _PERCENT < _PERCENT:
            self.register = (share + _PERCENT // 2) // _PERCENT

    def share_q16(self, effort_q16: int, velocity: int) -> int:
        """The same share without whole steps, of a size in Q16, smoothed over `SHARE_SHIFT`. In one tick more
        effort is never less torque."""
        share = effort_q16 * self.split // _PERCENT
        fade = self.fade
        if fade:
            share = share * max(0, fade - abs(velocity)) // fade
        self._share_q16 += (share - self._share_q16) >> SHARE_SHIFT
        return self._share_q16
