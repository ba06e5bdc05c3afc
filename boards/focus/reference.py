"""Absolute referencing: the index pulse gives the place, the LVDT tells which of the four it is (paper, 3.3).

The LVDT alone is good to a fraction of a millimetre; the pulses are 2.5 mm apart and exact to a half step.
"""

from typing import Final

from boards.focus.config import FocusConfig

_MIDDLE: Final = 512
_HALF_RANGE: Final = 512
"""ADC counts from the middle of the travel to its end, at nominal LVDT gain (hardware.md 1.3)."""


class Reference:
    """The search: towards the middle until the index input rises."""

    __slots__ = ("_config", "_index", "_start", "active", "failed")

    def __init__(self, config: FocusConfig) -> None:
        self._config = config
        self._index = False
        self._start = 0
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
