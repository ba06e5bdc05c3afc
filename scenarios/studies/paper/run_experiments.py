"""`schmidt paper`: run the rows, print published beside emulated, write JSON and the table."""

import itertools
import json
from collections.abc import Callable, Mapping, Sequence
from datetime import date
from functools import partial
from pathlib import Path
from time import monotonic
from typing import Any

from rich.console import Console

from host.logs.files import write_file
from plant.model import load
from plant.parts import PlantModel
from scenarios.campaign.executor import each
from scenarios.progress import shown
from scenarios.studies.options import PaperOptions
from scenarios.studies.paper.experiments import EXPERIMENTS, Experiment, Figures
from scenarios.studies.paper.rows import Row, markdown
from scenarios.studies.paper.starts import QUICK, STARTS, Benches, EmulatorBench, Start, others

Outcome = tuple[Figures, str]
"""Figures, or why there are none."""
DEAREST = ("E7", "E6", "E8", "E11", "E3", "E5", "E13", "E1")
"""Begun first, so that no process is left with a long one at the end."""


def measure(experiment: Experiment, plants: Mapping[str, PlantModel], start: Start) -> Outcome:
    """Run one experiment at one start. A plant on which it cannot be evaluated misses the row."""
    try:
        return experiment.measure(Benches(EmulatorBench, plants, start)), ""
    except ValueError as error:
        return {}, str(error)


def _job(plants: Mapping[str, PlantModel], job: tuple[str, Start]) -> Outcome:
    """What a process does: experiments are found by name, functions of modules travel badly."""
    name, start = job
    return measure(next(row for row in EXPERIMENTS if row.id == name), plants, start)


def run_rows(
    plants: Mapping[str, PlantModel],
    experiments: Sequence[Experiment],
    starts: Sequence[Start],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Callable[[str], None] = lambda text: None,
) -> list[Row]:
    """Return the rows: every experiment at every start is a job of its own with its own simulation.

    workers: processes. scheduler: address of a Dask cluster instead. progress: told after every job what it
    was.
    """
    ranks = {name: rank for rank, name in enumerate(DEAREST)}
    ordered = sorted((row.id for row in experiments), key=lambda name: ranks.get(name, len(ranks)))
    jobs = {f"{name} {place}": (name, start) for name in ordered for place, start in enumerate(starts)}
    found: dict[str, dict[Start, Outcome]] = {name: {} for name in ordered}
    for done in each(partial(_job, plants), jobs.items(), jobs=workers, scheduler=scheduler):
        if done.value is None:
            raise RuntimeError(f"{done.key}: {done.error}")
        name, start = jobs[done.key]
        found[name][start] = done.value
        progress(name)
    return [row_of(row, {start: found[row.id][start] for start in starts}) for row in experiments]


def row_of(experiment: Experiment, outcomes: Mapping[Start, Outcome]) -> Row:
    """Return a row of what was found at its starts."""
    return Row(
        experiment,
        {start: figures for start, (figures, why) in outcomes.items() if not why},
        {start: why for start, (_, why) in outcomes.items() if why},
    )


def select(names: str | None) -> list[Experiment]:
    """Return the experiments named by a comma-separated list; all without one. Raises ValueError."""
    if names is None:
        return list(EXPERIMENTS)
    wanted = [name.strip().upper() for name in names.split(",") if name.strip()]
    known = {row.id: row for row in EXPERIMENTS}
    strange = [name for name in wanted if name not in known]
    if strange or not wanted:
        raise ValueError(f"--rows: '{', '.join(strange) or names}' is no row; there are {', '.join(known)}")
    return [row for row in EXPERIMENTS if row.id in wanted]


def as_json(
    rows: Sequence[Row], plants: Mapping[str, str], seconds: float, starts: Sequence[Start]
) -> dict[str, Any]:
    """Return what `--json` writes."""
    return {
        "plant": plants["low"],
        "plants": dict(plants),
        "starts": [{"angle_deg": start.angle_deg, "seed": start.seed} for start in starts],
        "wall_s": round(seconds, 1),
        "rows": [row.as_json() for row in rows],
    }


def paper(options: PaperOptions) -> int:
    """Run the paper's experiments.

    Returns 0 when every row is met at every start, 1 when one is missed. Raises ValueError for a file that
    cannot be used.
    """
    console, out = Console(), options.out
    files = {"low": options.plant, "high": options.plant_high}
    plants = {preload: load(name) for preload, name in files.items()}
    chosen, starts = select(options.rows), QUICK if options.quick else STARTS
    starts = others(options.others) if options.others else starts
    write_file(out / ".probe", "")  # find out before minutes of work, not after
    (out / ".probe").unlink()
    begin = monotonic()
    with shown("experiments", len(chosen) * len(starts)) as tell:
        count = itertools.count(1)
        found = run_rows(
            plants,
            chosen,
            starts,
            workers=options.jobs,
            scheduler=options.scheduler,
            progress=lambda text: tell(next(count), text),
        )
    seconds = monotonic() - begin
    document = json.dumps(as_json(found, files, seconds, starts), indent=2, ensure_ascii=False) + "\n"
    write_file(options.json_file or out / "paper.json", document)
    command = f"schmidt paper --others {options.others}" if options.others else "schmidt paper"
    names = [Path(name).stem if name.endswith(".yaml") else name for name in files.values()]
    table = markdown(found, names, command, date.today())
    console.print(table, markup=False, highlight=False, soft_wrap=True)
    write_file(out / "experiments.md", table)
    met = sum(row.passed for row in found)
    where = f"at {len(starts)} starts" + (" (eight decide: leave --quick out)" if options.quick else "")
    console.print(f"{met} of {len(found)} rows met {where}, {seconds:.0f} s")
    return 0 if met == len(found) else 1
