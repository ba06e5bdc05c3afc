"""Runs the cases and puts worst and median of every case into a table."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from plant.parts import PlantModel
from scenarios.language.firmware import parameters_of
from scenarios.studies.objective.bench import MODES, Held, hold
from scenarios.studies.objective.bound import Bound
from scenarios.studies.objective.cases import PAPER, Case, starts
from scenarios.studies.options import ObjectiveOptions

MUST = 1.0
"""arcsec/s: the paper's objective."""
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
        firmware = [row for row in known.items() if row[0] not in case.without]
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


HEADINGS = ("plant and firmware", "mode", "peak, worst", "median", "rms, worst", "angle, worst", "runs", "")


def line(row: Row) -> tuple[str, ...]:
    """Cells of a row: arcsec/s, and arcsec for the angle."""
    verdict = "printed" if not row.judged else ("met" if row.passed else "missed")
    return (
        row.case, row.mode, f"{row.worst:.3f}", f"{float(np.median(row.peaks)):.3f}",
        f"{max(row.rms):.3f}", f"{max(row.wander):.3f}", str(len(row.peaks)), verdict,
    )  # fmt: skip


def bound_line(case: str, bound: Bound) -> tuple[str, ...]:
    """Cells of a bound, which has an rms and no peak."""
    return (f"{case}, {BOUND}", "", "", "", f"{bound.rms:.3f}", "", "", "bound")


def markdown(rows: list[Row], command: str, bounds: Mapping[str, Bound]) -> str:
    """The table for docs."""
    text = [f"True rate against 15.041″/s, in ″/s; angle off a straight line, in ″. `{command}`", ""]
    text += ["| " + " | ".join(HEADINGS) + " |", "|---|---|" + "---:|" * 5 + "---|"]
    lines = [line(row) for row in rows] + [bound_line(*each) for each in bounds.items()]
    text += ["| " + " | ".join(cells) + " |" for cells in lines]
    return "\n".join(text) + "\n"
