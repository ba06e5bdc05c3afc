"""The table: plants with more in them than the declared one and firmwares, worst and median of their runs."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml

from bus.protocol import AxisParameter
from plant.model import with_effects
from plant.parts import EffectModel, PlantModel
from plant.wind import wind
from scenarios.language.configure import parameters_of
from scenarios.studies.objective.bench import MODES, Held, hold
from scenarios.studies.objective.bound import Bound
from scenarios.studies.options import ObjectiveOptions

PAPER = "the paper's firmware"
STARTS = 8
FIRST_DEG, LAST_DEG = 85.0, 265.0
"""Of the absolute encoder: 95 deg before the middle of the travel to 85 deg after it."""


@dataclass(frozen=True)
class Case:
    """One row: which plant, what is added to it, which firmware, with the compensation table or not."""

    name: str
    effects: Sequence[str] = ()
    firmware: str = "fine"
    without: Sequence[str] = ()
    """Parameters of the firmware that are left out: the steps of a ladder."""
    compensated: bool = False
    high: bool = False
    wind_m_s: float = 0.0

    def plant(self, low: PlantModel, high: PlantModel) -> PlantModel:
        """The plant with the effects added to those it has."""
        model = high if self.high else low
        added = [EffectModel(name) for name in self.effects]
        if self.wind_m_s:
            added.append(wind(self.wind_m_s))
        return with_effects(model, "ra", (*model.axes.ra.effects, *added))


_ROWS = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8"))


def cases(compensation: bool) -> tuple[Case, ...]:
    """Rows of the table; with a compensation file, those of the fine firmware once more with it."""
    rows = (Case(**row) for row in _ROWS["table"])
    return tuple(row for row in rows if compensation or not row.compensated)


def ladder() -> tuple[Case, ...]:
    """The firmware's changes one after the other, on the declared plant and with all four effects."""
    return tuple(Case(**row) for row in _ROWS["ladder"])


def starts(shift_deg: float, count: int = STARTS) -> list[float]:
    """Start angles, deg of the absolute encoder, evenly over the travel; `shift_deg` moves all of them.

    Neighbours are 22.9 deg apart, no multiple of a gear's order, so each has its own phases.
    """
    spacing = (LAST_DEG - FIRST_DEG) / (count - 0.13)
    return [FIRST_DEG + (k * spacing + shift_deg) % (LAST_DEG - FIRST_DEG) for k in range(count)]


MUST = 1.0  # arcsec/s: the paper's objective.
BOUND = "the least possible"


class Row(NamedTuple):
    """One case in one mode. peaks: arcsec/s, by start and seed."""

    case: str
    mode: str
    peaks: list[float]
    rms: list[float]
    wander: list[float]
    lost: int
    judged: bool
    """Whether the objective is asked of it: not of the paper's firmware, of high preload, nor in wind."""

    @property
    def worst(self) -> float:
        """Largest of the peaks."""
        return max(self.peaks)

    @property
    def passed(self) -> bool:
        """Within the objective; rows that are printed only always pass."""
        return not self.judged or (self.worst <= MUST and self.lost == 0)

    def as_json(self) -> dict[str, Any]:
        """Fields of objective.json."""
        return {**self._asdict(), "worst": self.worst, "median": float(np.median(self.peaks)),
                "runs": len(self.peaks), "passed": self.passed}  # fmt: skip


def measure(
    cases: Iterable[Case],
    plants: tuple[PlantModel, PlantModel],
    compensation: Sequence[tuple[int, int]],
    options: ObjectiveOptions,
    tell: Callable[[str], None],
) -> Iterable[Row]:
    """One row per case and mode; `tell(text)` before each run. options: which starts, seeds, how long."""
    for case in cases:
        model = case.plant(*plants)
        known = parameters_of(case.firmware, model)
        firmware = [row for row in known.items() if AxisParameter(row[0]).name not in case.without]
        parameters = [*firmware, *(compensation if case.compensated else ())]
        for mode in MODES:
            held: list[Held] = []
            for start in starts(options.shift, options.starts):
                for seed in range(1, options.seeds + 1):
                    tell(f"{case.name}, {mode}, {start:.1f} deg, seed {seed}")
                    held.append(hold(model, start, seed, mode, parameters, options.seconds))
            yield Row(
                case=case.name, mode=mode, peaks=[each.peak for each in held],
                rms=[each.rms for each in held], wander=[each.wander for each in held],
                lost=sum(each.lost for each in held),
                judged=case.firmware != "paper" and not (case.high or case.without or case.wind_m_s),
            )  # fmt: skip


def over_paper(rows: Iterable[Row]) -> dict[str, float]:
    """Rms over that of the paper's firmware in the same wind, start and seed: the largest of each row."""
    known = {(row.case, row.mode): row for row in rows}
    return {
        f"{case}, {mode}": max(fine / paper for fine, paper in zip(row.rms, other.rms, strict=True))
        for (case, mode), row in known.items()
        if case.startswith("wind") and (other := known.get((f"{case}, {PAPER}", mode))) is not None
    }


HEADINGS = "| plant and firmware | mode | peak, worst | median | rms, worst | angle, worst | runs | |"


def line(row: Row) -> str:
    """A row of the page: arcsec/s, and arcsec for the angle."""
    verdict = "printed" if not row.judged else ("met" if row.passed else "missed")
    numbers = row.worst, float(np.median(row.peaks)), max(row.rms), max(row.wander)
    cells = (row.case, row.mode, *(f"{each:.3f}" for each in numbers), str(len(row.peaks)), verdict)
    return f"| {' | '.join(cells)} |"


def bound_line(case: str, bound: Bound) -> str:
    """A row of a bound, which has an rms and no peak."""
    return f"| {case}, {BOUND} |  |  |  | {bound.rms:.3f} |  |  | bound |"


def markdown(rows: list[Row], command: str, bounds: Mapping[str, Bound]) -> str:
    """The table for docs."""
    text = [f"True rate against 15.041″/s, in ″/s; angle off a straight line, in ″. `{command}`", ""]
    text += [HEADINGS, "|---|---|" + "---:|" * 5 + "---|"]
    text += [*map(line, rows), *(bound_line(*each) for each in bounds.items())]
    return "\n".join(text) + "\n"
