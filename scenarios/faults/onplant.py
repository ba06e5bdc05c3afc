"""Faults of actuators and of what they move."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from plant.kernels import layout as at
from scenarios.faults.drives import AXES
from scenarios.faults.place import Place

_ARCSEC_PER_RAD = 206_264.806247


class _Motor:
    """One motor whose switches give one duty, whatever is wanted."""

    duty: float

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        self._drives, self._axis, self._motor = place.drives, given["axis"], given["motor"]
        self._drives.add(self._axis, self, t_ns)

    def duties(self, wanted: tuple[float, float]) -> tuple[float, float]:
        """Of motors A and B."""
        return (self.duty, wanted[1]) if self._motor == "a" else (wanted[0], self.duty)

    def clear(self, t_ns: int) -> None:
        """The switches obey again."""
        self._drives.remove(self._axis, self, t_ns)


class MotorOpen(_Motor):
    """A lead is off: no voltage reaches the winding."""

    duty = 0.0


class MosfetShort(_Motor):
    """The switch conducts all the time."""

    duty = 1.0


class _Turned:
    """Numbers of the plant's world turned by a function, on one axis or both."""

    places: tuple[int, ...]

    def __init__(self, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        plant = place.network.plant
        self.given = given
        self._dials, self._plant = place.dials, plant
        axes = [AXES[given["axis"]]] if "axis" in given else list(AXES.values())
        self._places = [axis * at.WIDTH + each for axis in axes for each in self.places]
        self._turn: Callable[[float], float] = self.turn
        plant.advance(t_ns)
        for each in self._places:
            self._dials.add(plant.view, each, self._turn)

    def turn(self, value: float) -> float:
        """What becomes of a number."""
        return value * float(self.given["factor"])

    def clear(self, t_ns: int) -> None:
        """As it was."""
        self._plant.advance(t_ns)
        for each in self._places:
            self._dials.remove(self._plant.view, each, self._turn)


class WeakSupply(_Turned):
    """The motors' supply has less voltage."""

    places = (at.VOLTAGE, at.RIPPLE)


class Friction(_Turned):
    """Coulomb and breakaway friction are other than declared."""

    places = (at.DECLARED_FRICTION + at.F_COULOMB, at.DECLARED_FRICTION + at.F_STICTION)


class Load(_Turned):
    """The moved mass is another."""

    places = (at.INERTIA,)


class Play(_Turned):
    """The gear train has more play."""

    places = (at.HALF_PLAY,)

    def turn(self, value: float) -> float:
        """Half of it on each side."""
        return value + 0.5 * float(self.given["angle"]) / _ARCSEC_PER_RAD
