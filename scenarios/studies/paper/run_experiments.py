"""`schmidt paper`: run the rows, print published beside emulated, write JSON and the table.

With `--vary` the same rows on drives with one number off.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from datetime import date
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
from scenarios.studies.paper import varied
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


def _job(job: tuple[varied.Plants, str, Start]) -> Outcome:
    """What a process does: experiments are found by name, functions of modules travel badly."""
    plants, name, start = job
    return measure(next(row for row in EXPERIMENTS if row.id == name), plants, start)


def run_rows(
    many: Mapping[str, varied.Plants],
    experiments: Sequence[Experiment],
    starts: Sequence[Start],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Callable[[int, str], None] = lambda place, text: None,
) -> dict[str, list[Row]]:
    """Return the rows by drive: every experiment at every start is a job of its own with its own simulation.

    workers: processes. scheduler: address of a Dask cluster instead. progress: told after every job which it
    was and its row.
    """
    ranks = {name: rank for rank, name in enumerate(DEAREST)}
    jobs = {
        f"{drive} {row.id} {place}": (drive, row.id, start)
        for row in sorted(experiments, key=lambda row: ranks.get(row.id, len(ranks)))
        for drive in many
        for place, start in enumerate(starts)
    }
    outcomes: dict[str, Outcome] = {}
    tasks = ((key, (many[drive], name, start)) for key, (drive, name, start) in jobs.items())
    for done in each(_job, tasks, jobs=workers, scheduler=scheduler):
        if done.value is None:
            raise RuntimeError(f"{done.key}: {done.error}")
        outcomes[done.key] = done.value
        progress(len(outcomes), jobs[done.key][1])
    found: dict[tuple[str, str], dict[Start, Outcome]] = {}
    for key, (drive, name, start) in jobs.items():
        found.setdefault((drive, name), {})[start] = outcomes[key]
    return {drive: [row_of(row, found[drive, row.id]) for row in experiments] for drive in many}


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

    Returns 0 when every row is met at every start, 1 when one is missed. Raises ValueError for bad files.
    """
    console, out = Console(), options.out
    files = {"low": options.plant, "high": options.plant_high}
    plants: varied.Plants = {preload: load(name) for preload, name in files.items()}
    chosen, starts = select(options.rows), QUICK if options.quick else STARTS
    starts = others(options.others) if options.others else starts
    write_file(out / ".probe", "")  # find out before minutes of work, not after
    (out / ".probe").unlink()
    begin = monotonic()
    many = varied.variations(plants, options.vary) if options.vary else {"": plants}
    total = len(many) * len(chosen) * len(starts)
    with shown("experiments", total) as tell:
        found = run_rows(
            many, chosen, starts, workers=options.jobs, scheduler=options.scheduler, progress=tell
        )
    seconds = monotonic() - begin
    rows = [row for each in found.values() for row in each]
    file = options.json_file or out / f"{'varied' if options.vary else 'paper'}.json"
    documents = {name: as_json(each, files, seconds, starts) for name, each in found.items()}
    document: dict[str, Any] = documents if options.vary else documents[""]
    write_file(file, json.dumps(document, indent=2, ensure_ascii=False) + "\n")
    command = f"schmidt paper --others {options.others}" if options.others else "schmidt paper"
    if options.vary:
        command += f" --vary {options.vary:g}{' --quick' if options.quick else ''}"
        table = varied.markdown(found, command, options.vary)
    else:
        names = [Path(name).stem if name.endswith(".yaml") else name for name in files.values()]
        table = markdown(rows, names, command, date.today())
    console.print(table, markup=False, highlight=False, soft_wrap=True)
    write_file(out / f"{'varied' if options.vary else 'experiments'}.md", table)
    met = sum(row.passed for row in rows)
    where = f"at {len(starts)} starts" + (" (eight decide: leave --quick out)" if options.quick else "")
    console.print(f"{met} of {len(rows)} rows met {where}, {seconds:.0f} s")
    return 0 if met == len(rows) else 1
