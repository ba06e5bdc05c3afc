"""The dome: rotation and shutter, each by a geared motor that is on or off. Everything is an ASSUMPTION.

Kinematic: a dome that turns at one speed and stops at once is what an encoder of 0.1 deg can tell.
"""

from typing import Final

TURN_DEG_S: Final = 2.0
"""ASSUMPTION: 3 min a turn, as domes of some metres have."""
SHUTTER_S: Final = 30.0
"""From closed to open, ASSUMPTION."""
COUNTS: Final = 3600
"""Of the encoder on the rail, per turn, ASSUMPTION."""


class Travel:
    """A place that moves at one speed while its motor is on, and stops at once.

    speed: per second. place: where it is at first. span: it ends at 0 and there (None: it goes round).
    """

    def __init__(self, speed: float, place: float, span: float | None) -> None:
        self.speed = speed
        self.place = place
        self.span = span
        self.direction = 0
        self.since_ns = 0

    def at(self, t_ns: int) -> float:
        """Where it is."""
        place = self.place + self.direction * self.speed * (t_ns - self.since_ns) * 1e-9
        return place if self.span is None else min(max(place, 0.0), self.span)

    def drive(self, t_ns: int, direction: int) -> None:
        """Motor on (1, -1) or off (0) from `t_ns` on."""
        self.place = self.at(t_ns)
        self.since_ns = t_ns
        self.direction = direction


class DomePort:
    """Pins of the dome board."""

    def __init__(self) -> None:
        self._dome = Travel(TURN_DEG_S, 0.0, None)
        self._shutter = Travel(1.0 / SHUTTER_S, 0.0, 1.0)

    def turn(self, t_ns: int, direction: int) -> None:
        """Rotation motor: 1 towards larger azimuth, -1 back, 0 off."""
        self._dome.drive(t_ns, direction)

    def slide(self, t_ns: int, direction: int) -> None:
        """Shutter motor: 1 opens, -1 closes, 0 off."""
        self._shutter.drive(t_ns, direction)

    def azimuth(self, t_ns: int) -> float:
        """Where the slit looks, deg from the encoder's zero, unbounded."""
        return self._dome.at(t_ns)

    def encoder(self, t_ns: int) -> int:
        """Counts of the rail's encoder, 0..3599."""
        return round(self._dome.at(t_ns) * COUNTS / 360.0) % COUNTS

    def shutter(self, t_ns: int) -> float:
        """How far the shutter is open, 0..1."""
        return self._shutter.at(t_ns)
