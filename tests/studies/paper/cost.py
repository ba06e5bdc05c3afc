"""Distance of a pair of plants from all rows at once: 0 when every bound that the search watches holds.

A missed row costs 1 and up to as much again: the mean, over its limits and the starts, of how far each is
off. So the search prefers many rows to one that is nearly met, and every start that is won counts. Rows are
looked at in order of what they tell per second of computing; a point that is hopeless is left. E14 is
arithmetic (statics.py).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import fmean

from scenarios.studies.paper.experiments import EXPERIMENTS, Experiment
from scenarios.studies.paper.scales import TABLE_2
from scenarios.studies.paper.starts import Benches
from tests.studies.paper.statics import stall_current

ORDER = ("E1", "E10", "E3", "E12", "E6", "E15", "E5", "E11", "E2", "E13", "E4", "E9", "E8", "E7")
BY_ID = {row.id: row for row in EXPERIMENTS}
LEFT = 100.0
FULL = 3.0
"""Excess, in scales, at which a limit costs as much as it can."""


@dataclass(frozen=True)
class Term:
    """What one row costs, and the figure that decides it: name, worst value, excess in scales.

    share: mean over limits and starts of the excess, 0 (none) to 1 (all `FULL` off).
    """

    row: str
    figure: str
    value: float
    excess: float
    share: float

    @property
    def cost(self) -> float:
        """0 when met, 1 to 2 when missed."""
        return 0.0 if self.excess <= 0.0 else 1.0 + self.share

    @property
    def words(self) -> str:
        """The term for a line of progress."""
        return f"{self.row} {self.figure} {self.value:.3g}"


def _share(excess: float) -> float:
    return min(FULL, max(0.0, excess)) / FULL


def worst(row: Experiment, benches: Sequence[Benches]) -> Term:
    """Return the figure of a row that is farthest outside over all starts, and what all of them cost."""
    found: list[tuple[float, str, float]] = []
    for bench in benches:
        try:
            figures = row.measure(bench)
        except ValueError:
            found += [(FULL, "not evaluated", float("nan"))] * len(row.limits)
            continue
        for limit in row.limits:
            value = figures.get(limit.figure, float("nan"))
            found.append((limit.excess(value), limit.figure, value))
    excess, figure, value = max(found, key=lambda each: each[0])
    return Term(row.id, figure, value, excess, fmean(_share(each[0]) for each in found))


def stall_term(bench: Benches) -> Term:
    """Return E14's term by arithmetic: a run up to break-away would say the same and cost more than all
    rows."""
    axis = bench.plants["high"].axes.ra
    drive = {"torque_constant": axis.motor.torque_constant.si, "resistance": axis.motor.loop}
    stall = float(stall_current(drive, axis.friction.stiction.si / TABLE_2["high"]["stiction"]))
    off = BY_ID["E14"].limits[0].excess(stall)
    return Term("E14", "stall", stall, off, _share(off))


def terms(benches: Sequence[Benches], leave_out: Sequence[str] = ()) -> Iterator[Term]:
    """Yield every row's term but those of `leave_out`."""
    if "E14" not in leave_out:
        yield stall_term(benches[0])
    for name in ORDER:
        if name not in leave_out:
            yield worst(BY_ID[name], benches)


def cost(
    benches: Sequence[Benches], stop_at: float, leave_out: Sequence[str] = ()
) -> tuple[float, list[Term]]:
    """Return the sum of the terms and the terms; evaluation stops when the sum passes `stop_at`, at a
    price."""
    found: list[Term] = []
    total = 0.0
    for term in terms(benches, leave_out):
        found.append(term)
        total += term.cost
        if total > stop_at:
            return LEFT + total - len(found), found  # the fewer terms were reached, the worse
    return total, found
