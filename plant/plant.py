"""The plant: both axes and the focus, behind the pins of the boards."""

from collections.abc import Mapping
from typing import Final

from plant.axis import AxisPort
from plant.effects import REGISTRY
from plant.effects.signals import Hook
from plant.focus import FocusPort
from plant.grid import Grid
from plant.kernels import layout as at
from plant.kernels.advance import advance
from plant.parts import AxisModel, PlantModel
from plant.rows import values
from plant.units import TURN
from plant.world import AXES, build, grid_ns

COLUMNS: Final = (
    "effort",
    "position",
    "velocity",
    "currents",
    "tachometers",
)  # choice of channel_delay and log_wrap
LATE: Final = "channel_delay"


class Plant(Grid):
    """Both axes on one grid, and the focus.

    start_steps: where things stand at time 0: `ra`, `dec` in steps of the absolute encoder, `focus` in half
    steps.
    """

    def __init__(self, model: PlantModel, seed: int, start_steps: Mapping[str, float] | None = None):
        start = dict(start_steps or {})
        for word in start:
            if word != "focus" and word not in AXES:
                raise ValueError(f"plant: start_steps: '{word}' is not known; expected ra, dec, focus")
        angles = {name: start.get(name, 0.0) * TURN / 2 ** _bits(model, name) for name in AXES}
        self.model = model
        super().__init__(build(model, seed, angles), grid_ns(model))
        ports = []
        for row, name in enumerate(AXES):
            axis: AxisModel = getattr(model.axes, name)
            delays = delays_ns(axis)
            limit = (at.DELAY_ROWS - 2) * self.grid_ns
            if max(delays.values()) > limit:
                raise ValueError(f"plant: axes.{name}: channel_delay beyond {limit * 1e-9:g} s")
            self.world[row, at.DELAY_ON] = float(any(delays.values()))
            bits = axis.encoders.absolute.si, axis.encoders.auxiliary.si
            ports.append(AxisPort(self, row, delays, int(bits[0]), int(bits[1])))
        self.ra, self.dec = ports
        self.focus = FocusPort(model.focus, start.get("focus", 0.0))
        advance(self.world, 0)  # fill the readings

    def rail(self, t_ns: int) -> float:
        """Return the voltage of the motors' supply, V."""
        self.advance(t_ns)
        supply = self.model.supply
        return supply.voltage.si - supply.resistance.si * float(self.world[:, at.SUPPLY_CURRENT].sum())

    def log_effects(self, axis: str) -> list[tuple[str, dict[str, float]]]:
        """Return the effects of `axis` that the log writer has to apply, with parameters in SI units.

        Those of the hook LOG; of the delays only that of the column `effort`, as the plant delays the others.
        """
        part: AxisModel = getattr(self.model.axes, axis)
        found = []
        for effect in part.effects:
            given = values(effect)
            ours = effect.name == LATE and given["column"] != 0.0
            if effect.enabled and not ours and REGISTRY[effect.name].terms[0].hook == Hook.LOG:
                found.append((effect.name, given))
        return found


def _bits(model: PlantModel, axis: str) -> int:
    part: AxisModel = getattr(model.axes, axis)
    return int(part.encoders.absolute.si)


def delays_ns(axis: AxisModel) -> dict[str, int]:
    """Return the delay of each column of the log (COLUMNS), ns: the effects called channel_delay."""
    delays = dict.fromkeys(COLUMNS, 0)
    for effect in axis.effects:
        if effect.enabled and effect.name == LATE:
            given = values(effect)
            delays[COLUMNS[int(given["column"])]] += round(given["delay"] * 1e9)
    return delays
