"""Places wanted, turned into the rates that a board takes."""

from host.client import TICK_NS

TICK_S = TICK_NS * 1e-9
"""Between two commands at the most often, s."""
_LATE = 1.5
"""Ticks between two commands from which they are late; a tick more or less is 1 or 2."""


class Shifting:
    """Of one axis: the rate that brings it, within a tick, from where its rates have taken it to a place.

    made: where it begins, ″; t_s: when.
    """

    def __init__(self, made: float, t_s: float) -> None:
        self._made, self._rate, self._t_s = made, 0.0, t_s

    def rate(self, wanted: float, t_s: float) -> float:
        """″/s from now on, towards a place wanted a tick from now.

        A rate lasts until the next one is taken. Where that takes ticks, as on a slow machine, the way is
        given as long: in one tick it would be overshot, more every time.
        """
        gone_s = t_s - self._t_s
        self._made += self._rate * gone_s
        lasts_s = gone_s if gone_s > _LATE * TICK_S else TICK_S
        self._rate, self._t_s = (wanted - self._made) / lasts_s, t_s
        return self._rate
