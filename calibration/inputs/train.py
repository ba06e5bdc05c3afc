"""The gear train of a drive: tooth counts to periods, and what turns how often per turn of an axis."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Rig, Stage
from calibration.inputs.thresholds import HARMONICS
from calibration.inputs.units import units_per_turn

#: what the lines of a gear's stage are called: of a shaft that runs out of true, of teeth in mesh
SHAFT, MESH = "gear_eccentricity", "gear_mesh"
#: what a line once or more per turn of a part may be, where nobody said what the part is
OF_A_GUESS = (SHAFT, MESH, "motor_cogging")


@dataclass(frozen=True)
class Train:
    """Stages in the order they are declared: cycles per axis turn, and what each is."""

    orders: dict[str, float]
    kinds: dict[str, str | None]

    @property
    def shafts(self) -> tuple[str, ...]:
        """Everything that turns between the axis and the motors, and the roller on the axis."""
        return tuple(n for n, k in self.kinds.items() if k not in ("axis", "sensor", MESH))

    @property
    def toothed(self) -> tuple[str, ...]:
        """Shafts that carry a wheel or a pinion."""
        return tuple(n for n in self.shafts if self.kinds[n] != "roller")

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


def stages_of(path: Path, items: list[dict[str, Any]]) -> list[Stage]:
    """Resolve tooth counts to periods: a stage with `of` turns teeth[0]/teeth[1] as fast as the one named."""
    known: dict[str, Stage] = {}
    for item in items:
        name, period, period_s = item["name"], item.get("period"), item.get("period_s")
        if name in known:
            raise CalibrationInputError(path, f"stages: '{name}' is given twice")
        if "teeth" in item:
            if item["of"] not in known:
                raise CalibrationInputError(path, f"stages.{name}: 'of' must name a stage given before it")
            other, factor = known[item["of"]], item["teeth"][1] / item["teeth"][0]
            period, period_s = (x * factor if x else None for x in (other.period, other.period_s))
        given = item.get("harmonics", HARMONICS)
        listed = tuple(given) if isinstance(given, list) else ()
        known[name] = Stage(name, period, period_s, max(listed, default=given), item.get("kind"), listed)
    return list(known.values())
