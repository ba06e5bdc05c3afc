"""Many points of the search at a time, through the executor that campaigns use, here or on a cluster."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from plant.parts import PlantModel
from scenarios.campaign.executor import each
from scenarios.studies.paper.starts import Benches, Start
from tests.studies.paper.compiled import CompiledBench
from tests.studies.paper.cost import Term, cost

Priced = tuple[float, list[Term]]
"""Cost of a point, and what it is made of."""


@dataclass(frozen=True)
class Point:
    """A point as a worker is sent it. stop_at: a cost at which the rest of its rows is left out."""

    plants: Mapping[str, PlantModel]
    starts: tuple[Start, ...]
    stop_at: float
    leave_out: tuple[str, ...]


Pricer = Callable[[Sequence[Point]], list[Priced]]


def price(point: Point) -> Priced:
    """Cost of one point, wherever it is run."""
    benches = [Benches(CompiledBench, point.plants, start) for start in point.starts]
    return cost(benches, point.stop_at, point.leave_out)


def pricer(jobs: int | None, scheduler: str | None) -> Pricer:
    """What runs a batch and returns costs in its order. jobs: processes here; scheduler: address of a Dask
    cluster instead. Raises RuntimeError when a point could not be run at all."""

    def run(points: Sequence[Point]) -> list[Priced]:
        named = [(str(place), point) for place, point in enumerate(points)]
        found: dict[str, Priced] = {}
        for done in each(price, named, jobs=jobs, scheduler=scheduler):
            if done.value is None:
                raise RuntimeError(f"point {done.key} of {len(points)}: {done.error}")
            found[done.key] = done.value
        return [found[name] for name, _ in named]

    return run
