"""The speed profile of a move: the reference that the position loop follows, in integers.

Positions in Q18 counts, because one step of the absolute encoder is then exactly 55125 units
(112 896 000 counts / 2^29 steps x 2^18). Speeds in Q18 counts per tick. All are 64-bit integers (`long long`
of the dsPIC30F's compiler), and so is every product. The square root is taken only where the speed it gives
is below the top speed. So its radicand stays below (top + a)^2, 2^62, however far the target is.
The target may itself move (tracking): the profile is the distance still to go, relative to it.
"""

from math import isqrt
from typing import Final

from boards.core.widths import INT64_TOP, saturate

UNITS_PER_STEP: Final = 55_125
UNIT_SHIFT: Final = 18
_SPEED_TOP: Final = isqrt(INT64_TOP)
"""Q18 counts per tick, 11585 counts: fastest relative speed whose square fits; twice the rate is less."""


class Profile:
    """target: where to be, moving by `rate` a tick. remaining: reference to target. speed: of that
    distance.

    top: largest speed relative to the target. acceleration: change of speed per tick. All Q18 counts
        (per tick).
    """

    def __init__(self, acceleration: int) -> None:
        self.acceleration = acceleration
        self.target = 0
        self.rate = 0
        self.remaining = 0
        self.speed = 0
        self.top = 0

    def take_over(self, position: int, velocity: int) -> None:
        """Start from a measured position and the velocity in force; braking to `rate` ends at the target."""
        relative = saturate(velocity - self.rate, _SPEED_TOP)
        stop = relative * abs(relative) // (2 * self.acceleration)
        self.speed = relative
        self.remaining = stop
        self.target = position + stop

    def aim(self, position: int) -> None:
        """Move to `position` instead, from wherever the reference is."""
        self.remaining += position - self.target
        self.target = position

    def step(self) -> int:
        """One tick; returns the reference's velocity. The reference itself is `target - remaining`.

        Braking law: v(v + a) / 2a <= distance, the sum of the ticks until rest, solved for v.
        """
        self.target += self.rate
        gap, a, top = abs(self.remaining), self.acceleration, self.top
        wanted = top
        if gap <= top * (top + a) // (2 * a):
            wanted = isqrt((a * a >> 2) + 2 * a * gap) - (a >> 1)
        wanted = saturate(self.remaining, wanted)
        self.speed += saturate(wanted - self.speed, a)
        self.remaining -= self.speed
        return self.rate + self.speed
