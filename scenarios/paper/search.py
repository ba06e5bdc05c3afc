"""`python -m scenarios.paper.search --out DIR`: fit what the paper leaves open to all rows at once,
reproducibly.

Differential evolution over space.py on the compiled loop, started from points that pass the statics, then a
simplex from the best; seeded, one process. Writes the plant files with their sources, and what was tried.
The emulator has the last word: run `schmidt paper --plant ... --plant-high ...` on the result.
"""

import argparse
import dataclasses
import json
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np

from plant.model import load
from plant.parts import PlantModel
from scenarios.paper.bench import Bench
from scenarios.paper.compiled import CompiledBench
from scenarios.paper.cost import Term, cost
from scenarios.paper.log import Array
from scenarios.paper.plantfile import write
from scenarios.paper.proposals import propose
from scenarios.paper.space import SPACE, bounds, models, values, vector
from scenarios.paper.statics import shortfalls_of

READINGS = {
    "printed": (1.0, "{}_preload", "{}_preload_fitted"),
    "motor": (1.0 / 2.774, "{}_preload_motor_units", "{}_preload_motor_units"),
}
"""Friction as printed (N m at the axis), or Tc and Ts as N mm at the motor (hardware.md 2.3): N m at the axis
per unit of the table, the plant files whose declared numbers stay, and those that are written."""
UNREACHABLE = 1000.0
WORSE = 1e6


class Enough(Exception):
    """The search may try no more points, or need not."""


class Objective:
    """Cost of a search vector; keeps the best, and a record of every improvement."""

    def __init__(
        self, reading: str, low_speed: bool, margin: float, most: int, tell: Callable[[str], None]
    ) -> None:
        self.scale, base, _ = READINGS[reading]
        self.bases = {preload: load(base.format(preload)) for preload in ("low", "high")}
        self.low_speed = low_speed
        self.margin = margin
        self.tell = tell
        self.most = most
        self.best = WORSE
        self.best_x: Array | None = None
        self.best_terms: list[Term] = []
        self.tried = 0

    def plants(self, x: Array, source: str = "trial") -> dict[str, PlantModel]:
        """Return the two plants at a search vector."""
        return models(self.bases, values(x), source)

    def __call__(self, x: Array) -> float:
        """Return the cost at `x`; outside the bounds it grows with the distance."""
        if self.tried >= self.most or self.best == 0.0:
            raise Enough
        low, high = np.array(bounds()).T
        beyond = float(np.sum(np.maximum(0.0, low - x) + np.maximum(0.0, x - high)))
        if beyond > 0.0:
            return WORSE + beyond
        failing = float(shortfalls_of(values(x), self.scale, self.low_speed))
        if failing > 0.0:
            return UNREACHABLE * (1.0 + failing)
        plants = self.plants(x)

        def bench(preload: str, gains: tuple[float, float] | None = None) -> Bench:
            return CompiledBench(plants[preload], 1, gains)

        self.tried += 1
        found, terms = cost(bench, self.margin, self.low_speed)
        if found < self.best:
            self.best, self.best_x, self.best_terms = found, np.array(x), terms
            worst = sorted((term for term in terms if term.cost > 0.0), key=lambda term: -term.cost)[:4]
            self.tell(
                f"{self.tried:5d} {found:8.3f}  " + ", ".join(f"{t.name} {t.figure:.3g}" for t in worst)
            )
        return found


def start_points(objective: Objective, count: int, random: np.random.Generator, known: Array | None) -> Array:
    """Return `count` points: half of them the best that linear theory proposes (or the one known point), the
    rest scattered about these."""
    if known is None:
        sifted = propose(random, objective.scale, objective.low_speed, keep=count // 2)
        proposed = [proposal.x for proposal in sifted]
    else:
        proposed = [known]
    if not proposed:
        raise ValueError("linear theory finds no point of the space that could meet the rows")
    low, high = np.array(bounds()).T
    scattered = [
        np.clip(proposed[k % len(proposed)] + 0.15 * random.standard_normal(low.size), low, high)
        for k in range(count - len(proposed))
    ]
    return np.array([*proposed, *scattered])


def search(objective: Objective, seed: int, known: Array | None = None, population: int = 32) -> None:
    """Search until all points are used up or one costs nothing; the result is in `objective`."""
    from scipy.optimize import differential_evolution, minimize

    random = np.random.default_rng(seed)
    most = objective.most
    objective.most = round(0.7 * most)
    start = start_points(objective, population, random, known)
    with suppress(Enough):
        differential_evolution(
            objective, bounds(), init=start, maxiter=10_000, tol=0.0, polish=False, rng=random,
            mutation=(0.4, 0.9), recombination=0.8,
        )  # fmt: skip
    objective.most = most
    with suppress(Enough):
        while objective.best_x is not None:
            simplex = objective.best_x + 0.05 * random.standard_normal((len(SPACE) + 1, len(SPACE)))
            simplex[0] = objective.best_x
            minimize(objective, simplex[0], method="Nelder-Mead", options={"initial_simplex": simplex})


def report(objective: Objective, seed: int, seconds: float) -> dict[str, Any]:
    """Return what was found, for the JSON file."""
    assert objective.best_x is not None
    return {
        "seed": seed,
        "tried": objective.tried,
        "seconds": round(seconds, 1),
        "cost": objective.best,
        "values": values(objective.best_x),
        "bounds": {free.name: [free.low, free.high, free.unit, free.why] for free in SPACE},
        "terms": [
            {"name": t.name, "figure": round(t.figure, 4), "cost": round(t.cost, 4)}
            for t in objective.best_terms
        ],
    }


def main(arguments: list[str] | None = None) -> int:
    """Run the search from the command line."""
    parser = argparse.ArgumentParser(prog="python -m scenarios.paper.search", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder for plant files and report")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--points", type=int, default=900, help="how many points are run, about one a second")
    parser.add_argument("--margin", type=float, default=0.05, help="share by which the bands are narrowed")
    parser.add_argument(
        "--reading", choices=sorted(READINGS), default="motor", help="friction units of Table 2"
    )
    parser.add_argument(
        "--start", type=Path, help="search.json of an earlier run, to go on from its best point"
    )
    parser.add_argument("--without-e6", action="store_true", help="leave row E6 out")
    chosen = parser.parse_args(arguments)
    begin = monotonic()
    objective = Objective(
        chosen.reading,
        not chosen.without_e6,
        chosen.margin,
        chosen.points,
        lambda text: print(text, flush=True),
    )
    known = vector(json.loads(chosen.start.read_text(encoding="utf-8"))["values"]) if chosen.start else None
    search(objective, chosen.seed, known)
    if objective.best_x is None:
        print("no point of the space could be run at all", file=sys.stderr)
        return 1
    found = report(objective, chosen.seed, monotonic() - begin)
    chosen.out.mkdir(parents=True, exist_ok=True)
    (chosen.out / "search.json").write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    rows = "E1 to E5 and E10" if chosen.without_e6 else "E1 to E6 and E10"
    source = f"fitted to rows {rows} by scenarios.paper.search, seed {chosen.seed}"
    for preload, plant in objective.plants(objective.best_x, source).items():
        name = READINGS[chosen.reading][2].format(preload)
        write(dataclasses.replace(plant, name=name), chosen.out / f"{name}.yaml")
    print(f"cost {objective.best:.3f} after {objective.tried} points; plant files in {chosen.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
