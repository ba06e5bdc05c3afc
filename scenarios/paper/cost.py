"""Distance of a pair of plants from all rows at once: 0 when every bound that the search watches holds.

A missed row costs 1 and up to as much again by how far it is off, so the search prefers many rows to one that
is nearly met. Rows are looked at in order of what they tell per second of computing; a point that is hopeless
is left. E7 and E8 measure what the plant file declares and are not searched; E14 is arithmetic on the
resistance.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from scenarios.paper.experiments import EXPERIMENTS, Experiment
from scenarios.paper.starts import Benches

ORDER = ("E1", "E10", "E12", "E3", "E6", "E11", "E2", "E13", "E15", "E4", "E5", "E9")
BY_ID = {row.id: row for row in EXPERIMENTS}
SUPPLY_V = 24.0
LEFT = 100.0
FULL = 3.0
"""Excess, in scales, at which a row costs as much as it can."""


@dataclass(frozen=True)
class Term:
    """What one row costs, and the figure that makes it so: name, worst value, excess in scales."""

    row: str
    figure: str
    value: float
    excess: float

    @property
    def cost(self) -> float:
        """0 when met, 1 to 2 when missed."""
        return 0.0 if self.excess <= 0.0 else 1.0 + min(FULL, self.excess) / FULL

    @property
    def words(self) -> str:
        """The term for a line of progress."""
        return f"{self.row} {self.figure} {self.value:.3g}"


def worst(row: Experiment, benches: Sequence[Benches]) -> Term:
    """Return the figure of a row that is farthest outside over all starts."""
    found = Term(row.id, "not evaluated", float("nan"), FULL)
    farthest = -1e12
    for bench in benches:
        try:
            figures = row.measure(bench)
        except ValueError:
            return found
        for limit in row.limits:
            value = figures.get(limit.figure, float("nan"))
            excess = limit.excess(value)
            if excess > farthest:
                farthest = excess
                found = Term(row.id, limit.figure, value, excess)
    return found


def terms(benches: Sequence[Benches]) -> Iterator[Term]:
    """Yield every row's term."""
    motor = benches[0].plants["low"].axes.ra.motor
    stall = SUPPLY_V / (motor.resistance.si + motor.switch_resistance.si + motor.sense_resistance.si)
    yield Term("E14", "stall", stall, BY_ID["E14"].limits[0].excess(stall))
    for name in ORDER:
        yield worst(BY_ID[name], benches)


def cost(benches: Sequence[Benches], stop_at: float) -> tuple[float, list[Term]]:
    """Return the sum of the terms and the terms; evaluation stops when the sum passes `stop_at`, at a
    price."""
    found: list[Term] = []
    total = 0.0
    for term in terms(benches):
        found.append(term)
        total += term.cost
        if total > stop_at:
            return LEFT + total - len(found), found  # the fewer terms were reached, the worse
    return total, found
