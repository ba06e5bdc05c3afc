"""Where the motor goes and how fast, and the search for the absolute position.

The index pulse gives the place, the LVDT tells which of the four it is (paper, 3.3). The LVDT alone is good
to a fraction of a millimetre; the pulses are 2.5 mm apart and exact to a half step.
"""

from typing import Final

from boards.focus.config import FocusConfig


class Stepping:
    """position, target: half steps. `next()` says what the step timer does."""

    def __init__(self, config: FocusConfig) -> None:
        self._intervals = config.intervals_ns
        self.rebase(0)

    def rebase(self, position: int) -> None:
        """The place where the motor stands is called `position` from now on; it stops there."""
        self.position = self.target = position
        self.halt()

    def halt(self) -> None:
        """No more steps."""
        self._ramp = 0
        self.direction = 0
        self.moving = False

    def brake(self) -> None:
        """Come to rest as soon as the ramp allows."""
        self.target = self.position + self.direction * self._ramp

    def next(self) -> tuple[int, int]:
        """One half step: (direction, time to the next one in ns); direction 0: at rest, at the target."""
        away = self.target - self.position
        if not self._ramp:  # slow enough to stop or turn
            if not away:
                self.halt()
                return 0, 0
            self.direction = away // abs(away)
        ahead = away * self.direction
        if ahead <= self._ramp + 1:
            self._ramp = max(0, self._ramp - 1)
        elif self._ramp < len(self._intervals) - 1:
            self._ramp += 1
        self.position += self.direction
        return self.direction, self._intervals[self._ramp]


_MIDDLE: Final = 512
_HALF_RANGE: Final = 512
"""ADC counts from the middle of the travel to its end, at nominal LVDT gain (hardware.md 1.3)."""


class Reference:
    """The search: towards the middle until the index input rises."""

    def __init__(self, config: FocusConfig) -> None:
        self._config = config
        self.active = False
        self.failed = False

    def estimate(self, lvdt: int) -> int:
        """Position by the LVDT alone, half steps."""
        return (lvdt - _MIDDLE) * self._config.travel // _HALF_RANGE

    def begin(self, position: int, lvdt: int, index: bool) -> int:
        """Start the search; returns where to step to at most: a turn and a tenth, towards the middle."""
        self.active = True
        self.failed = False
        self._index = index
        reach = self._config.half_steps_per_turn * 11 // 10
        return position - reach if self.estimate(lvdt) > 0 else position + reach

    def look(self, lvdt: int, index: bool) -> int | None:
        """After each half step: the true position when the index has just come, else None."""
        rises = index and not self._index
        self._index = index
        if not rises:
            return None
        self.active = False
        here = self.estimate(lvdt)
        return min(self._config.index, key=lambda place: abs(place - here))

    def give_up(self) -> None:
        """The reach is exhausted: encoder, LVDT or motor does not do what it should."""
        self.active = False
        self.failed = True
