"""`python -m tests.studies.paper.survey --seed 1 --points 300 --out FILE.md`: a random look at all of it.

Points of a scrambled Sobol sequence over all of the space's numbers (logarithmic, within their bounds), those
that statics allow; rows on the compiled loop, each point from one of the eight starts in turn. It says which
rows random points meet, how near they come, and which rows are never met together. One start is easier than
eight: what is not met here is not met there.
"""

import argparse
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from scenarios.studies.paper.log import Array
from scenarios.studies.paper.starts import STARTS, Benches
from tests.studies.paper.compiled import CompiledBench
from tests.studies.paper.cost import BY_ID, Term, stall_term, worst
from tests.studies.paper.objective import Objective
from tests.studies.paper.space import bounds, values

ROWS = ("E1", "E2", "E3", "E4", "E5", "E6", "E9", "E12", "E13", "E14", "E15")
"""All but E7 and E8, which judge a method, and E10 and E11, which cost as much as all of these."""
EVERY = 20
"""Points after which what is there is written."""
DRAWN = 1 << 15
"""Sobol points from which those that statics allow are taken."""


@dataclass(frozen=True)
class Look:
    """One point: the free numbers, and what each row's worst figure was."""

    found: Mapping[str, float]
    terms: Mapping[str, Term]

    def met(self, row: str) -> bool:
        """Whether all limits of a row held."""
        return self.terms[row].excess <= 0.0


def draw(objective: Objective, seed: int) -> tuple[Array, float]:
    """Return the points that statics allow, (points, numbers), and their share."""
    from scipy.stats import qmc

    low, high = np.array(bounds()).T
    drawn = low + (high - low) * qmc.Sobol(low.size, rng=np.random.default_rng(seed)).random(DRAWN)
    possible = np.array([x for x in drawn if objective.shortfall(x) == 0.0])
    return possible, len(possible) / DRAWN


def looks(objective: Objective, points: Array, rows: Sequence[str] = ROWS) -> Iterator[Look]:
    """Yield the points with their rows, each from one start."""
    for k, x in enumerate(points):
        bench = Benches(CompiledBench, objective.plants(x), STARTS[k % len(STARTS)])
        found = {row: stall_term(bench) if row == "E14" else worst(BY_ID[row], [bench]) for row in rows}
        yield Look(values(x), found)


def _figure(term: Term) -> str:
    limit = next(each for each in BY_ID[term.row].limits if each.figure == term.figure)
    unit = "" if limit.unit == "1" else f" {limit.unit}"
    return f"{limit.words} {term.value:.3g}{unit} ({limit.bounds})" if term.value == term.value else "none"


def markdown(found: Sequence[Look], share: float, said: str, rows: Sequence[str] = ROWS) -> str:
    """Return the tables: row by row, and which rows a row that is met leaves."""
    most = max(sum(look.met(row) for row in rows) for look in found)
    lines = [
        f"{len(found)} points, {said}; statics allow {100.0 * share:.2g} % of the space. At most {most} "
        f"of these {len(rows)} rows are met at one point.",
        "",
        "| row | met at | nearest: its worst figure | median of that excess, in scales | never met with it |",
        "|---|---:|---|---:|---|",
    ]
    for row in rows:
        terms = [look.terms[row] for look in found]
        where = [look for look in found if look.met(row)]
        nearest = min(terms, key=lambda term: term.excess)
        known = [min(term.excess, 99.0) for term in terms if term.excess == term.excess]
        never = [each for each in rows if each != row and not any(look.met(each) for look in where)]
        beside = ("all" if len(never) == len(rows) - 1 else ", ".join(never) or "none") if where else "–"
        lines.append(f"| {row} | {len(where)} | {_figure(nearest)} | {median(known):.2g} | {beside} |")
    return "\n".join(lines) + "\n"


def as_json(found: Sequence[Look]) -> list[dict[str, Any]]:
    """Return every point: its numbers, and by row the deciding figure, its value and whether it is met."""
    return [
        dict(look.found) | {row: [t.figure, t.value, t.excess <= 0.0] for row, t in look.terms.items()}
        for look in found
    ]


def main(arguments: list[str] | None = None) -> int:
    """Run the survey from the command line."""
    parser = argparse.ArgumentParser(prog="python -m tests.studies.paper.survey", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="Markdown; the points go beside it as JSON")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--points", type=int, default=300)
    chosen = parser.parse_args(arguments)
    objective = Objective(STARTS, chosen.points, print)
    points, share = draw(objective, chosen.seed)
    said, text = f"seed {chosen.seed}", ""
    chosen.out.parent.mkdir(parents=True, exist_ok=True)
    found: list[Look] = []
    for look in looks(objective, points[: chosen.points]):
        found.append(look)
        if len(found) % EVERY == 0 or len(found) == min(chosen.points, len(points)):
            text = markdown(found, share, said)
            chosen.out.write_text(text, encoding="utf-8")
            chosen.out.with_suffix(".json").write_text(json.dumps(as_json(found)) + "\n", encoding="utf-8")
            print(f"{len(found)} points", flush=True)
    if not found:
        print("no point of the space passes the statics", file=sys.stderr)
        return 1
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
