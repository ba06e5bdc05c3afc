"""The gear train of an axis: what turns how often per turn of it."""

from __future__ import annotations

from dataclasses import dataclass

from calibration.inputs.declaration import Rig, Stage
from calibration.inputs.units import units_per_turn

#: what a stage of an axis with two motors may be; a shaft where nothing is said
KINDS = ("axis", "motor", "roller", "sensor", "gear_mesh", "gear_eccentricity", None)


@dataclass(frozen=True)
class Train:
    """Stages in the order they are declared: cycles per axis turn, and what each is."""

    orders: dict[str, float]
    kinds: dict[str, str | None]

    @property
    def known(self) -> dict[str, float]:
        """Stages whose torque the axis feels: all but sensors on shafts of their own."""
        return {n: v for n, v in self.orders.items() if self.kinds[n] != "sensor"}

    @property
    def shafts(self) -> tuple[str, ...]:
        """Everything that turns between the axis and the motors, and the roller on the axis."""
        return tuple(n for n, k in self.kinds.items() if k not in ("axis", "sensor", "gear_mesh"))

    @property
    def toothed(self) -> tuple[str, ...]:
        """Shafts that carry a wheel or a pinion."""
        return tuple(n for n in self.shafts if self.kinds[n] != "roller")

    @property
    def meshes(self) -> tuple[str, ...]:
        """Teeth in mesh."""
        return tuple(n for n, k in self.kinds.items() if k == "gear_mesh")

    def one(self, kind: str) -> str | None:
        """The stage of a kind of which an axis has one."""
        return next((n for n, k in self.kinds.items() if k == kind), None)

    @property
    def motor(self) -> str:
        """The motors' shaft."""
        return self.one("motor") or ""

    @property
    def ratio(self) -> float:
        """Motor turns per axis turn."""
        return self.orders[self.motor]


def train_of(rig: Rig) -> Train:
    """The train of a rig whose stages have periods in position units."""
    turn = rig.turn or units_per_turn(rig.columns["position"].unit if rig.columns else "turn") or 1.0
    stages: list[Stage] = [s for s in rig.stages if s.period]
    return Train({s.name: turn / (s.period or turn) for s in stages}, {s.name: s.kind for s in stages})
