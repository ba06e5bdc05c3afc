"""What the search minimises: the cost of a point of the space, on the compiled loop."""

from collections.abc import Callable, Sequence

import numpy as np

from plant.model import load
from plant.parts import PlantModel
from scenarios.studies.paper.measures import Array
from scenarios.studies.paper.starts import Benches, Start
from tests.studies.paper.compiled import CompiledBench
from tests.studies.paper.cost import Term, cost
from tests.studies.paper.space import bounds, models, values
from tests.studies.paper.statics import shortfalls_of
from tests.studies.paper.together import Point, Pricer

SCALE = 1.0 / 2.774
"""N m at the axis per N mm at the motor, as which Tc and Ts of Table 2 are read (hardware.md 2.3)."""
NAME = "{}_preload_bridge"
"""Plant files whose declared numbers stay, and which are written."""
WORSE = 1e6
UNREACHABLE = 1000.0
ROOM = 2.0
"""How far beyond the best a point may cost before the rest of its rows is left out."""


class Enough(Exception):
    """The search may try no more points, or need not."""


class Objective:
    """Cost of a search vector; keeps the best, and a record of every improvement."""

    def __init__(
        self,
        starts: tuple[Start, ...],
        most: int,
        tell: Callable[[str], None],
        leave_out: Sequence[str] = (),
        together: Pricer | None = None,
    ) -> None:
        self.bases = {preload: load(NAME.format(preload)) for preload in ("low", "high")}
        self.starts = starts
        self.leave_out = leave_out
        self.together = together
        self.tell = tell
        self.most = most
        self.best = WORSE
        self.best_x: Array | None = None
        self.best_terms: list[Term] = []
        self.tried = 0
        self.noted: Callable[[int], None] | None = None
        self.room = ROOM

    def plants(self, x: Array, source: str = "trial") -> dict[str, PlantModel]:
        """Return the two plants at a search vector."""
        return models(self.bases, values(x), source)

    def shortfall(self, x: Array) -> float:
        """Return by how much statics say that a point cannot be."""
        return float(shortfalls_of(values(x), SCALE))

    def beyond(self, x: Array) -> float | None:
        """Return the cost of a point that need not be run: outside the bounds it grows with the distance."""
        low, high = np.array(bounds()).T
        beyond = float(np.sum(np.maximum(0.0, low - x) + np.maximum(0.0, x - high)))
        if beyond > 0.0:
            return WORSE + beyond
        failing = self.shortfall(x)
        return UNREACHABLE * (1.0 + failing) if failing > 0.0 else None

    def __call__(self, x: Array) -> float:
        """Return the cost at `x`."""
        known = self.beyond(x)
        if known is not None:
            return known
        if self.tried >= self.most or self.best == 0.0:
            raise Enough
        plants = self.plants(x)
        benches = [Benches(CompiledBench, plants, start) for start in self.starts]
        found, terms = cost(benches, self.best + self.room, self.leave_out)
        self._note(x, found, terms)
        return found

    def many(self, points: Array) -> Array:
        """Return the costs of the columns of `points`, (numbers, points), run together; those that there are
        no more points for cost WORSE."""
        assert self.together is not None
        known = [self.beyond(x) for x in points.T]
        wanted = [place for place, each in enumerate(known) if each is None]
        if wanted and (self.tried >= self.most or self.best == 0.0):
            raise Enough
        wanted = wanted[: self.most - self.tried]
        stop_at, left_out = self.best + self.room, tuple(self.leave_out)
        run = [Point(self.plants(points[:, k]), self.starts, stop_at, left_out) for k in wanted]
        for k, (found, terms) in zip(wanted, self.together(run) if run else [], strict=True):
            known[k] = found
            self._note(points[:, k], found, terms)
        return np.array([WORSE if each is None else each for each in known])

    def _note(self, x: Array, found: float, terms: list[Term]) -> None:
        self.tried += 1
        if self.noted is not None:
            self.noted(self.tried)
        if found < self.best:
            self.best, self.best_x, self.best_terms = found, np.array(x), terms
            missed = [term for term in terms if term.excess > 0.0]
            self.tell(
                f"{self.tried:5d} {found:7.3f}  {len(missed)} missed: " + ", ".join(t.words for t in missed)
            )
