"""`python -m tests.benchmarks.campaigns [--runs N] [--planned N]`: what a campaign costs beside its runs.

Overhead and the gain of a second worker are measured on runs of about five seconds, the client's memory on
many planned runs that do nothing. CPU time is told apart from wall time: on a machine with neighbours only
the former says anything, on an idle one the latter is what a user sees.
"""

import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import click

from scenarios.campaign import table
from scenarios.campaign.job import Row
from scenarios.campaign.plan import Case

ROOT = Path(__file__).parents[2]
_RUN = """\
name: five seconds
start_utc: 2026-02-10T14:00:00Z
steps:
  - power_on: {}
  - set_rate: {axis: ra, rate: 100 arcsec/s, for: %d s}
expect:
  - overruns: {at_most: 0}
"""
_CAMPAIGN = """\
name: bench
scenario: run.yaml
budget: {runs: %d}
metrics: [expectations, bus_load]
inputs:
  - {plant: axes.ra.friction.coulomb, times: {between: [0.8, 1.2]}}
  - {plant: axes.ra.inertia, times: {between: [0.8, 1.2]}}
  - {name: seed, seed: true, is: {between: [1, 100000], whole: true}}
"""
RUN_S = 5.0
"""What a run is to take, CPU s."""
_LOOP = 50_000_000
"""Turns of an empty loop: some seconds."""
_TRIED_S = 100
"""Simulated seconds that tell how fast this machine is today."""


def nothing(job: Case) -> Row:
    """A run that does nothing: a row of the usual width, from its inputs alone."""
    from scenarios.run.probe import digest

    row: Row = {"key": job.key, "index": job.index, "failure": "", "passed": True, "missed": ""}
    row |= {f"input: {name}": value for name, value in job.values.items()}
    first, second, *_ = job.values.values()
    row |= {"metric: overruns": 0, "metric: bus_load": 0.1 * first + 0.01 * second, "simulated_s": 0.0}
    row |= {"wall_s": 0.0, "cpu_s": 0.0, "probe": digest(), "digest": job.key * 4, "version": "0"}
    return row | {"compiled": True, "machine": "none"}


def planned(folder: Path, runs: int, jobs: int) -> dict[str, float]:
    """A campaign of `runs` that do nothing, in this process; its peak memory, MiB, and time."""
    from scenarios.campaign.options import CampaignOptions
    from scenarios.campaign.run_campaign import campaign

    _write(folder, runs, 1)
    begin, cpu = time.perf_counter(), time.process_time()
    options = CampaignOptions(file=folder / "bench.yaml", out=folder / "out", jobs=jobs)
    status = campaign(options, nothing)
    if status:
        raise RuntimeError(f"the campaign ended with {status}")
    return {
        "runs": runs,
        "peak_MiB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
        "cpu_ms_a_run": 1e3 * (time.process_time() - cpu) / runs,
        "wall_s": time.perf_counter() - begin,
    }


def timed(folder: Path, runs: int, jobs: int, simulated_s: int) -> dict[str, float]:
    """A campaign by the command line: wall and CPU time of all its processes, and of its runs alone."""
    _write(folder, runs, simulated_s)
    out = folder / f"jobs-{jobs}-{runs}"
    words = ["campaign", str(folder / "bench.yaml"), "--out", str(out), "--jobs", str(jobs)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)  # users have it written
    command = [sys.executable, "-c", "from scenarios.cli import main; main()", *words]
    before, begin = _children_s(), time.perf_counter()
    subprocess.run(command, env=environment, check=True, capture_output=True)
    wall_s, cpu_s = time.perf_counter() - begin, _children_s() - before
    rows = list(table.rows(out / table.JOURNAL))
    own_s = sum(row["cpu_s"] for row in rows)
    return {"runs": runs, "jobs": jobs, "wall_s": wall_s, "cpu_s": cpu_s, "runs_cpu_s": own_s,
            "runs_wall_s": sum(row["wall_s"] for row in rows), "overhead": cpu_s / own_s - 1.0}  # fmt: skip


def ceiling() -> float:
    """What a second worker is worth to a loop that shares nothing with it: the most this machine can give."""
    command = [sys.executable, "-c", f"for _ in range({_LOOP}): pass"]

    def wall_s(count: int) -> float:
        begin = time.perf_counter()
        processes = [subprocess.Popen(command) for _ in range(count)]
        for process in processes:
            process.wait()
        return time.perf_counter() - begin

    return statistics.median(2.0 * wall_s(1) / wall_s(2) for _ in range(5))


def measure(runs: int) -> dict[str, Any]:
    """Overhead with one worker and two, and what the second is worth."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        tried = timed(folder, 1, 1, _TRIED_S)
        simulated_s = max(1, round(_TRIED_S * RUN_S / tried["runs_cpu_s"]))
        least = timed(folder, 2, 1, 1)
        one, two = (timed(folder, runs, jobs, simulated_s) for jobs in (1, 2))
    return {
        "simulated_s": simulated_s,
        "once_s": least["cpu_s"] - least["runs_cpu_s"],
        "one": one,
        "two": two,
        "speedup": one["wall_s"] / two["wall_s"],
        "busy": two["runs_wall_s"] / (2.0 * two["wall_s"]),
        "ceiling": ceiling(),
        "dearer": two["runs_cpu_s"] / one["runs_cpu_s"],
    }


def _write(folder: Path, runs: int, simulated_s: int) -> None:
    (folder / "run.yaml").write_text(_RUN % simulated_s)
    (folder / "bench.yaml").write_text(_CAMPAIGN % runs)


def _children_s() -> float:
    found = resource.getrusage(resource.RUSAGE_CHILDREN)
    return found.ru_utime + found.ru_stime


def show(found: dict[str, Any]) -> None:
    """Print what `measure` found."""
    one, two = found["one"], found["two"]
    each_s = one["runs_cpu_s"] / one["runs"]
    print(f"runs of {each_s:.1f} s CPU ({found['simulated_s']} simulated), load {os.getloadavg()[0]:.1f}")
    for name, part in (("one worker", one), ("two workers", two)):
        times = (
            f"{part['wall_s']:.1f} s wall, {part['cpu_s']:.1f} s CPU, {part['runs_cpu_s']:.1f} s in the runs"
        )
        print(f"{name}: {part['runs']:.0f} runs, {times}: overhead {part['overhead']:.1%} (<= 10 %)")
    print(f"once a campaign with one worker, its start and report: {found['once_s']:.1f} s CPU")
    print(f"two workers over one: {found['speedup']:.2f} times by wall time (>= 1.8, idle machine;", end=" ")
    print(f"two empty loops over one here: {found['ceiling']:.2f})")
    print(f"  both busy {found['busy']:.1%} of the time; a run's CPU {found['dearer']:.2f} times that alone")


@click.command()
@click.option("--runs", default=24, show_default=True, help="Runs of five seconds; 0: none.")
@click.option("--planned", "many", default=0, show_default=True, help="Runs that do nothing.")
@click.option("--jobs", default=2, show_default=True, help="Workers of those.")
@click.option("--json", "json_file", type=click.Path(path_type=Path))
def main(runs: int, many: int, jobs: int, json_file: Path | None) -> None:
    """Measure what a campaign costs beside its runs."""
    found: dict[str, Any] = {}
    if runs:
        found["overhead"] = measure(runs)
        show(found["overhead"])
    if many:
        with tempfile.TemporaryDirectory() as name:
            found["planned"] = planned(Path(name), many, jobs)
        each = found["planned"]
        cost = f"{each['cpu_ms_a_run']:.2f} ms CPU of it a run, {each['wall_s']:.0f} s"
        print(f"{each['runs']} planned runs: client's peak {each['peak_MiB']:.0f} MiB (<= 500), {cost}")
    if json_file is not None:
        json_file.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
