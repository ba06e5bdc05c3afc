"""Faults of sensors: something else lies between the plant and the chip that reads it."""

from collections import deque
from collections.abc import Mapping
from typing import Any

from scenarios.lab.faults.place import UNITS, Place
from scenarios.lab.layers import Laid


class Sensor(Laid):
    """A sensor whose readings are changed by `show`."""

    def __init__(self, place: Place, given: Mapping[str, Any], _t_ns: int) -> None:
        self.random = place.random
        owner, name, self._motor = place.pin(given["sensor"])
        self.given, self._evidence = given, place.evidence
        super().__init__(place.layers, owner, name)

    def __call__(self, t_ns: int, *motor: int) -> Any:
        """In the place of the pin."""
        reading = self.below(t_ns, *motor)
        if self._motor is not None and motor != (self._motor,):
            return reading
        shown = self.show(t_ns, reading)
        if shown != reading:
            self._evidence.act(t_ns, f"sample of {self.given['sensor']}")
        return shown

    def show(self, t_ns: int, reading: Any) -> Any:
        """What the board sees of a reading."""
        raise NotImplementedError


class Stuck(Sensor):
    """Shows what it showed when it was first read."""

    _held: Any = None

    def show(self, _t_ns: int, reading: Any) -> Any:
        """The first reading."""
        if self._held is None:
            self._held = reading
        return self._held


class Off(Sensor):
    """A reading that is a number, off by what is given: a factor about zero, an offset, white noise."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        if given["sensor"] == "focus.index":
            raise ValueError("sensor: focus.index is a level; it can be stuck, late or intermittent")
        super().__init__(place, given, t_ns)

    def show(self, _t_ns: int, reading: Any) -> Any:
        """The nearest there is: counters count."""
        value = float(reading) * float(self.given.get("factor", 1.0)) + float(self.given.get("offset", 0.0))
        if "deviation" in self.given:
            value += float(self.given["deviation"]) * float(self.random.standard_normal())
        return value if isinstance(reading, float) else round(value)


class Delayed(Sensor):
    """Shows what was read some time ago (before that much is known: the first)."""

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        self._past: deque[tuple[int, Any]] = deque()
        self._delay_ns = round(given["delay"] * 1e9)
        super().__init__(place, given, t_ns)

    def show(self, t_ns: int, reading: Any) -> Any:
        """The newest reading that is old enough."""
        past = self._past
        past.append((t_ns, reading))
        while len(past) > 1 and past[1][0] <= t_ns - self._delay_ns:
            past.popleft()
        return past[0][1]


class Intermittent(Sensor):
    """A bad contact: in a share of the readings it shows the last good one."""

    _last: Any = None

    def show(self, _t_ns: int, reading: Any) -> Any:
        """The reading, or the one before."""
        if self._last is None or self.random.random() >= self.given["probability"]:
            self._last = reading
        return self._last


def unit(sensor: str) -> str:
    """Unit of a sensor's readings."""
    return UNITS.get(sensor.partition(".")[2], "counts")
