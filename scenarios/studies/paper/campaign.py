"""All experiments at all starts, spread over processes: every one is a job of its own with its own
simulation."""

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial

from plant.parts import PlantModel
from scenarios.campaign.executor import each
from scenarios.studies.paper.emulator import EmulatorBench
from scenarios.studies.paper.experiments import EXPERIMENTS, Experiment, Figures
from scenarios.studies.paper.rows import Row
from scenarios.studies.paper.starts import STARTS, Benches, Start

Progress = Callable[[str], None]
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


def rows(
    plants: Mapping[str, PlantModel],
    *,
    experiments: Sequence[Experiment] = EXPERIMENTS,
    starts: Sequence[Start] = STARTS,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress = lambda text: None,
) -> list[Row]:
    """Return the rows. workers: processes; 1: none but this one. scheduler: address of a Dask cluster
    instead. progress: told after every job what it was."""
    jobs = [(experiment, start) for experiment in _ordered(experiments) for start in starts]
    found: dict[tuple[str, Start], Outcome] = {}
    count = min(workers or os.cpu_count() or 1, len(jobs))
    if count == 1 and scheduler is None:
        for experiment, start in jobs:
            found[experiment.id, start] = measure(experiment, plants, start)
            progress(experiment.id)
    else:
        named = {
            f"{experiment.id} {place}": (experiment.id, start)
            for place, (experiment, start) in enumerate(jobs)
        }
        for done in each(partial(_job, plants), named.items(), jobs=count, scheduler=scheduler):
            if done.value is None:
                raise RuntimeError(f"{done.key}: {done.error}")
            found[named[done.key]] = done.value
            progress(named[done.key][0])
    return [_row(experiment, starts, found) for experiment in experiments]


def _ordered(experiments: Iterable[Experiment]) -> list[Experiment]:
    def place(experiment: Experiment) -> int:
        return DEAREST.index(experiment.id) if experiment.id in DEAREST else len(DEAREST)

    return sorted(experiments, key=place)


def _row(experiment: Experiment, starts: Sequence[Start], found: Mapping[tuple[str, Start], Outcome]) -> Row:
    outcomes = {start: found[experiment.id, start] for start in starts}
    return Row(
        experiment,
        {start: figures for start, (figures, why) in outcomes.items() if not why},
        {start: why for start, (_, why) in outcomes.items() if why},
    )
