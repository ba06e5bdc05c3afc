"""Faults of actuators and of what they move."""

from collections.abc import Mapping
from typing import Any

from bus.units import ARCSEC_PER_RAD
from plant.kernels import layout as at
from scenarios.lab.faults.kind import Active
from scenarios.lab.faults.place import Place
from scenarios.lab.layers import AXES, Staged, Watched


class OneDuty(Staged):
    """One motor whose switches give one duty, whatever is wanted."""

    def __init__(self, duty: float, place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        self._duty, self._motor = duty, given["motor"]
        super().__init__(place.network, given["axis"], place.evidence, t_ns)

    def duties(self, wanted: tuple[float, float]) -> tuple[float, float]:
        """Of motors A and B."""
        return (self._duty, wanted[1]) if self._motor == "a" else (wanted[0], self._duty)


class EmergencyStop:
    """The button of the safety chain (`scenarios/lab/chain.py`) is pressed while the fault is on."""

    def __init__(self, place: Place, _given: Mapping[str, Any], t_ns: int) -> None:
        chain = place.network.chain
        if chain is None:
            raise ValueError("emergency_stop: this network has no safety chain (network.chain)")
        self._chain = chain
        if chain.press(t_ns):
            place.evidence.act(t_ns, "safety chain")

    def clear(self, t_ns: int) -> None:
        """The button is pulled out again; the chain stays open until both axes are OFF."""
        self._chain.release(t_ns)


class _Driven(Staged):
    """Passes duties on."""

    def duties(self, wanted: tuple[float, float]) -> tuple[float, float]:
        """Those."""
        if any(wanted):
            self._evidence.act(self._queue.now_ns, f"duties of {self._axis}")
        return wanted


class Turned:
    """Numbers of the plant's world, at their `places` in an axis' row, multiplied on one axis or both."""

    def __init__(self, places: tuple[int, ...], place: Place, given: Mapping[str, Any], t_ns: int) -> None:
        plant = place.network.plant
        self.given = given
        self._dials, self._plant = place.dials, plant
        axes = [given["axis"]] if "axis" in given else list(AXES)
        self._places = [AXES[axis] * at.WIDTH + each for axis in axes for each in places]
        plant.advance(t_ns)
        before = [plant.view[each] for each in self._places]
        for each in self._places:
            self._dials.add(plant.view, each, self)
        moved = [plant.view[each] for each in self._places] != before
        driven = [name for name in axes if moved and f"AXIS_{name.upper()}" in place.network.boards]
        self._watches = [self.watch(place, name, t_ns) for name in driven]

    def watch(self, place: Place, axis: str, _t_ns: int) -> Active:
        """What tells that the changed numbers have counted: the axis has moved."""
        owner, name, _ = place.pin(f"{axis}.incremental")
        return Watched(place.layers, (owner, name), place.evidence, f"{axis}.incremental")

    def turn(self, value: float) -> float:
        """What becomes of a number."""
        return value * float(self.given["factor"])

    def clear(self, t_ns: int) -> None:
        """As it was."""
        self._plant.advance(t_ns)
        for watch in self._watches:
            watch.clear(t_ns)
        for each in self._places:
            self._dials.remove(self._plant.view, each, self)


class WeakSupply(Turned):
    """The motors' supply has less voltage."""

    def watch(self, place: Place, axis: str, t_ns: int) -> Active:
        """A motor is driven: it need not move."""
        return _Driven(place.network, axis, place.evidence, t_ns)


class Play(Turned):
    """The gear train has more play."""

    def turn(self, value: float) -> float:
        """Half of it on each side."""
        return value + 0.5 * float(self.given["angle"]) / ARCSEC_PER_RAD
