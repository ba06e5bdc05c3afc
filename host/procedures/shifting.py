"""Places wanted, turned into the rates that a board takes."""

from host.client import TICK_NS

TICK_S = TICK_NS * 1e-9
"""Between two commands at the most often, s."""


class Shifting:
    """Of one axis: the rate that brings it, within a tick, from where its rates have taken it to a place.

    made: where it begins, ″; t_s: when.
    """

    def __init__(self, made: float, t_s: float) -> None:
        self._made, self._rate, self._t_s = made, 0.0, t_s

    def rate(self, wanted: float, t_s: float) -> float:
        """″/s from now on, towards a place wanted a tick from now."""
        self._made += self._rate * (t_s - self._t_s)
        self._rate, self._t_s = (wanted - self._made) / TICK_S, t_s
        return self._rate
