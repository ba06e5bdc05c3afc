"""Where the motor goes and how fast: a half-step counter, a target, a ramp."""

from boards.focus.config import FocusConfig


class Stepping:
    """position, target: half steps. `next()` says what the step timer does."""

    __slots__ = ("_intervals", "_ramp", "direction", "moving", "position", "target")

    def __init__(self, config: FocusConfig) -> None:
        self._intervals = config.intervals_ns
        self._ramp = 0
        self.direction = 0
        self.moving = False
        self.position = 0
        self.target = 0

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
        ahead = (self.target - self.position) * self.direction
        if not self._ramp and ahead <= 0:  # slow enough to stop or turn
            if self.target == self.position:
                self.halt()
                return 0, 0
            self.direction = 1 if self.target > self.position else -1
            ahead = abs(self.target - self.position)
        if ahead <= self._ramp + 1:
            self._ramp = max(0, self._ramp - 1)
        elif self._ramp < len(self._intervals) - 1:
            self._ramp += 1
        self.position += self.direction
        return self.direction, self._intervals[self._ramp]
