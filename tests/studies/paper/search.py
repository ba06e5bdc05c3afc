"""`python -m tests.studies.paper.search --out DIR`: fit what the paper leaves open to all rows at once,
reproducibly.

Sobol points of the space of space.py that pass the statics, scipy's differential evolution on the compiled
loop from several such populations, then short steps from the best of all, a third of the numbers at a time;
with `--start` those steps alone, from a known point. Seeded. Writes plant files with their sources, and what
was tried. The emulator has the last word: `schmidt paper --plant ... --plant-high ...`.

One process, every point held against the last; with `--jobs` or `--scheduler` a generation, or BATCH short
steps, at a time, all held against the best before them: another way through the space, and the same one
whatever the number of workers.
"""

import argparse
import dataclasses
import json
import signal
import sys
from contextlib import suppress
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np

from scenarios.progress import shown
from scenarios.studies.paper.measures import Array
from scenarios.studies.paper.starts import STARTS
from tests.studies.paper.objective import NAME, Enough, Objective
from tests.studies.paper.plantfile import write
from tests.studies.paper.space import SPACE, bounds, values, vector
from tests.studies.paper.together import pricer

SEARCHED = STARTS[::2]
"""Starts of a point: four of the eight that decide."""
POPULATION = 24
SIFTED = 4096
"""Sobol points of which those that pass the statics are taken."""
STEP_SHARE = 0.25
"""Of the points, for the short steps."""
STEP, MOVED, AGAIN = 0.08, 0.35, 0.3
"""Of a short step: spread (logarithmic), share of the numbers that move, how often the last step that helped
is tried again."""

BATCH = 8
"""Short steps at a time, where points are run together."""


def population(objective: Objective, seed: int) -> Array:
    """Return a first population: Sobol points that pass the statics."""
    from scipy.stats import qmc

    low, high = np.array(bounds()).T
    random = np.random.default_rng(seed)
    sobol = low + (high - low) * qmc.Sobol(low.size, rng=random).random(SIFTED)
    possible = sobol[[objective.shortfall(x) == 0.0 for x in sobol]]
    return np.asarray(possible[:POPULATION], dtype=np.float64)


def evolve(objective: Objective, seeds: tuple[int, ...]) -> None:
    """Differential evolution from one population per seed, each with its share of the points."""
    from scipy.optimize import differential_evolution

    most = objective.most
    for k, seed in enumerate(seeds):
        objective.most = round(most * (k + 1) / len(seeds))
        start = population(objective, seed)
        if len(start) < 5:
            raise ValueError("hardly a point of the space passes the statics; there is nothing to search")
        objective.tell(f"      population {seed}")
        with suppress(Enough):
            differential_evolution(
                objective.many if objective.together else objective, bounds(), init=start, maxiter=10_000,
                tol=0.0, polish=False, rng=np.random.default_rng(seed), mutation=(0.4, 0.9),
                recombination=0.8, vectorized=objective.together is not None,
                updating="deferred" if objective.together else "immediate",
            )  # fmt: skip


def descend(objective: Objective, start: Array, seed: int, spread: float = STEP) -> None:
    """Short steps from a point, each from the best so far; a step that costs more is not run to its end.
    spread: of a step, logarithmic."""
    random = np.random.default_rng(seed)
    low, high = np.array(bounds()).T
    objective.room = 0.0
    helped: Array | None = None

    def step() -> Array:
        if helped is not None and random.random() < AGAIN:
            return np.asarray(helped * random.uniform(0.3, 1.5))
        return np.asarray(spread * random.standard_normal(low.size) * (random.random(low.size) < MOVED))

    with suppress(Enough):
        if objective.best_x is None:
            objective(start)
        while True:
            best, before = objective.best, start if objective.best_x is None else objective.best_x
            if objective.together is None:
                taken = step()
                objective(np.clip(before + taken, low, high))
            else:
                steps = [step() for _ in range(BATCH)]
                found = objective.many(np.array([np.clip(before + each, low, high) for each in steps]).T)
                taken = steps[int(np.argmin(found))]
            if objective.best < best:
                helped = taken


def search(
    objective: Objective, seeds: tuple[int, ...], known: Array | None = None, spread: float = STEP
) -> None:
    """Search until all points are used up or one costs nothing; the result is in `objective`."""
    most = objective.most
    if known is None:
        objective.most = round(most * (1.0 - STEP_SHARE))
        evolve(objective, seeds)
        known, objective.most = objective.best_x, most
    if known is not None:
        descend(objective, known, seeds[0], spread)


def report(objective: Objective, seeds: tuple[int, ...], seconds: float) -> dict[str, Any]:
    """Return what was found, for the JSON file."""
    assert objective.best_x is not None
    return {
        "seeds": list(seeds),
        "starts": [dataclasses.asdict(start) for start in objective.starts],
        "left_out": list(objective.leave_out),
        "tried": objective.tried,
        "seconds": round(seconds, 1),
        "cost": objective.best,
        "values": values(objective.best_x),
        "bounds": {free.name: [free.low, free.high, free.unit, free.why] for free in SPACE},
        "rows": [
            {"row": t.row, "figure": t.figure, "value": round(t.value, 4), "met": t.excess <= 0.0}
            for t in objective.best_terms
        ],
    }


def main(arguments: list[str] | None = None) -> int:
    """Run the search from the command line."""
    parser = argparse.ArgumentParser(prog="python -m tests.studies.paper.search", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder for plant files and report")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2], help="one population each")
    parser.add_argument("--points", type=int, default=900, help="how many points are run")
    parser.add_argument("--start", type=Path, help="search.json to go on from")
    parser.add_argument("--step", type=float, default=STEP, help="spread of a short step, logarithmic")
    parser.add_argument(
        "--leave-out", default="", metavar="E1,E2,...", help="rows that nothing can meet: not looked at"
    )
    parser.add_argument("--all-starts", action="store_true", help="every point from eight starts, not four")
    parser.add_argument("--jobs", type=int, help="points at a time in so many processes")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="points at a time on a Dask cluster")
    chosen = parser.parse_args(arguments)
    begin = monotonic()
    for number in (signal.SIGINT, signal.SIGTERM):  # ends the search, and what was found is written
        signal.signal(number, signal.default_int_handler)

    def tell(text: str) -> None:
        print(text, flush=True)

    left_out = [name for name in chosen.leave_out.upper().split(",") if name]
    starts = STARTS if chosen.all_starts else SEARCHED
    many = pricer(chosen.jobs, chosen.scheduler) if chosen.jobs or chosen.scheduler else None
    objective = Objective(starts, chosen.points, tell, left_out, many)
    known = vector(json.loads(chosen.start.read_text(encoding="utf-8"))["values"]) if chosen.start else None
    seeds = tuple(chosen.seeds)
    with suppress(KeyboardInterrupt), shown("fitting", chosen.points) as show:
        objective.noted = lambda tried: show(tried, f"best cost {objective.best:.3f}")
        search(objective, seeds, known, chosen.step)
    if objective.best_x is None:
        print("no point of the space could be run at all", file=sys.stderr)
        return 1
    found = report(objective, seeds, monotonic() - begin)
    chosen.out.mkdir(parents=True, exist_ok=True)
    (chosen.out / "search.json").write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    source = f"fitted to rows E1 to E15 by tests.studies.paper.search, seeds {seeds}"
    for preload, plant in objective.plants(objective.best_x, source).items():
        name = NAME.format(preload)
        write(dataclasses.replace(plant, name=name), chosen.out / f"{name}.yaml")
    print(f"cost {objective.best:.3f} after {objective.tried} points; plant files in {chosen.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
