"""Wind on the telescope as the weather station's mast feels it, less what the dome keeps off.

Both axes get the torque of `plant/wind.py`, each with gusts of its own. The mast's input gives the mean
speed; a fault of the station's sensor leaves the wind as it is. A network without a dome stands in the open.
"""

from collections.abc import Callable
from math import radians
from typing import TYPE_CHECKING, Final

from boards.core.declared import DeclaredBoard
from plant.dome import DomePort
from plant.effects.wind_torque import formula
from plant.kernels import layout as at
from plant.model import with_effects
from plant.parts import PlantModel
from plant.rows import KINDS
from plant.wind import share, torque, wind
from plant.world import AXES

if TYPE_CHECKING:
    from scenarios.lab.network import Network

MAST: Final = "WEATHER_MAST"
EVERY_NS: Final = 1_000_000_000
"""As often as the station measures; in a second the dome turns by 2 deg."""


def in_the_wind(model: PlantModel) -> PlantModel:
    """The plant with a place for the wind on both axes, still."""
    for axis in AXES:
        model = with_effects(model, axis, (*getattr(model.axes, axis).effects, wind(0.0)))
    return model


class Blowing:
    """from_rad: azimuth the wind comes from. Raises ValueError when there is no station on the mast."""

    def __init__(self, network: "Network", from_rad: float) -> None:
        mast = network.boards.get(MAST)
        if not isinstance(mast, DeclaredBoard):
            raise ValueError(f"network: wind_from: there is no board {MAST} to say how much it blows")
        self._wind: Callable[[int], float] = mast.pins["wind"]
        self.dome: DomePort | None = network.dome
        self._from_rad = from_rad
        self._network = network
        world = network.plant.world
        self.places = []
        for row, each in enumerate(world):
            kinds = (at.EFFECTS + number * at.ROW + at.ROW_KIND for number in range(int(each[at.ROWS_ALL])))
            self.places.append(row * at.WIDTH + max(place for place in kinds if each[place] == _KIND))
        self._blow(network.queue.now_ns)

    def speed(self, t_ns: int) -> float:
        """In the slit, m/s."""
        outside = self._wind(t_ns)
        if self.dome is None:
            return outside
        away = radians(self.dome.azimuth(t_ns)) - self._from_rad
        return outside * share(away, self.dome.shutter(t_ns))

    def _blow(self, t_ns: int) -> None:
        plant = self._network.plant
        plant.advance(t_ns)
        for place in self.places:
            for number, value in enumerate(torque(self.speed(t_ns))):
                plant.view[place + _FIRST + number] = value
        self._network.queue.at(t_ns + EVERY_NS, self._blow)


_KIND: Final = float(KINDS[formula])
_FIRST: Final = at.ROW_MEMORY + 4 - at.ROW_KIND
"""From a row's kind to its first parameter: memory and seed lie between."""
