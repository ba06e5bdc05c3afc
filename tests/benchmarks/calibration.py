"""`python -m tests.benchmarks.calibration [--json FILE] [--quick]`: time of a log, two peers."""

import json
import os
import platform
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from pathlib import Path
from time import perf_counter
from typing import Any

import click
from rich.console import Console
from rich.table import Table

from scenarios.progress import stages
from tests.benchmarks.drives import TRUE_LINES, Drive, write_drive
from tests.benchmarks.peers import Answer, MissingPeer, Residual, residual_of, sindy, whole_vector

SEED = 1001  # a development seed: 1000 to 1999
ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "NUMBA", "VECLIB_MAXIMUM")}
LIMIT_S, TEN_LIMIT_S = 20.0, 240.0  # asked for: one log on one core, ten on two
STAGES_OF = {"gravity_imbalance": ("axis", 1)}  # a finding without a stage of its own

USUAL_S = {
    "logs": 10.0,
    "schmidt calibrate, one log on one core": 20.0,
    "the same residual for the peers": 5.0,
    "PySINDy": 10.0,
    "scipy least squares": 30.0,
    "schmidt calibrate, many logs on two cores": 200.0,
}  # ASSUMPTION, of the order of the limits; the pace at hand is measured


class BenchmarkFailed(ValueError):
    """`schmidt calibrate` gave no answer."""


def calibrate(drive: Drive, out: Path) -> tuple[float, dict[str, Any]]:
    """Seconds of the whole command in its own process with one thread, and its report."""
    command = Path(sys.executable).with_name("schmidt")
    begin = perf_counter()
    done = subprocess.run(
        [str(command), "calibrate", str(drive.path), "--out", str(out)],
        env={**os.environ, **ONE_THREAD},
        capture_output=True,
        text=True,
    )
    seconds = perf_counter() - begin
    if done.returncode:
        raise BenchmarkFailed(f"schmidt calibrate {drive.path.name}: {done.stderr.strip()}")
    report: dict[str, Any] = json.loads((out / "report.json").read_text(encoding="utf-8"))
    return seconds, report


def answer_of(seconds: float, report: dict[str, Any], cpu_s: float = 0.0) -> Answer:
    """The report in the peers' terms; terms are the effects on top of the declared model."""
    torque = report["error"]["torque"]
    lines = [
        STAGES_OF.get(e["name"], (e["stage"], e["harmonic"]))
        for e in report["effects"]
        if e["channel"] == "T"
    ]
    return Answer(
        seconds,
        cpu_s,
        torque["before"],
        torque["after"],
        len(report["effects"]),
        tuple(lines),
        f"{report['verdict']}: {', '.join(e['name'] for e in report['effects'])}; "
        f"floor {torque['floor']:.3g}",
    )


def _children_s() -> float:
    """CPU seconds of all processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def measure(quick: bool) -> dict[str, Any]:
    """All figures. quick: two logs of two minutes instead of ten of ten, to try the benchmark itself."""
    seconds, count = (120.0, 2) if quick else (600.0, 10)
    with tempfile.TemporaryDirectory() as name, stages("bench of calibration", USUAL_S) as stage:
        folder = Path(name)
        stage("logs")
        drives = [write_drive(folder / f"log{k}.csv", seconds, SEED + k) for k in range(count)]
        stage("schmidt calibrate, one log on one core")
        before_s = _children_s()
        alone_s, report = calibrate(drives[0], folder / "alone")
        alone_cpu_s = _children_s() - before_s
        stage("the same residual for the peers")
        residual = residual_of(drives[0])
        answers = {"schmidt calibrate": answer_of(alone_s, report, alone_cpu_s)}
        missing = {}
        peers: tuple[tuple[str, Callable[[Residual], Answer]], ...] = (
            ("PySINDy", sindy),
            ("scipy least squares", whole_vector),
        )
        for title, peer in peers:
            stage(title)
            try:
                answers[title] = peer(residual)
            except MissingPeer as error:
                missing[title] = str(error)
        stage("schmidt calibrate, many logs on two cores")
        begin = perf_counter()
        with ThreadPoolExecutor(2) as pool:
            many = list(pool.map(lambda d: calibrate(d, folder / d.path.stem), drives))
        many_s = perf_counter() - begin
    right = sum(answer_of(*each).named for each in many)
    extra = sum(len(each[1]["effects"]) > len(TRUE_LINES) for each in many)
    return {
        "machine": {
            "processor": platform.processor() or platform.machine(),
            "cores": os.cpu_count(),
            "load": os.getloadavg(),
        },
        "python": platform.python_version(),
        "seed": SEED,
        "log": {"seconds": seconds, "rows": drives[0].rows, "amplitudes_Nm": drives[0].amplitudes},
        "one_log": {k: {**asdict(v), "named": v.named, "unit": "N m"} for k, v in answers.items()},
        "missing": missing,
        "many_logs": {"logs": count, "seconds": many_s, "both_named": right, "with_more": extra},
    }


def show(figures: dict[str, Any], console: Console) -> None:
    """Print the figures beside what was asked for."""
    log, many, machine = figures["log"], figures["many_logs"], figures["machine"]
    table = Table(
        title=f"{log['rows']} rows ({log['seconds'] / 60:g} min), {machine['cores']} cores, "
        f"load {machine['load'][0]:.1f}; true: gravity imbalance and shaft 1 eccentricity"
    )
    for column in (
        "tool",
        "time, s",
        "CPU, s",
        "held-out, N m: before",
        "after",
        "terms",
        "both named",
        "other lines",
        "note",
    ):
        table.add_column(column)
    for title, a in figures["one_log"].items():
        others = [f"{s} {h}" for s, h in a["lines"] if (s, h) not in TRUE_LINES]
        table.add_row(
            title,
            f"{a['seconds']:.1f}",
            f"{a['cpu_seconds']:.1f}",
            f"{a['before']:.2f}",
            f"{a['after']:.2f}",
            str(a["terms"]),
            "yes" if a["named"] else "no",
            str(len(others)),
            a["note"],
        )
    for title, reason in figures["missing"].items():
        table.add_row(title, "", "", "", "", "", "", "", reason)
    console.print(table)
    console.print(
        "Times: schmidt calibrate is the whole command from reading the log to the report, in its own "
        f"process on one core (asked for: 60 000 rows in ≤ {LIMIT_S:g} s); the peers are given the finished "
        "residual and the gear table, and their time is the fit alone. Before: each tool's own declared "
        "part without effects. Other lines: of shafts and meshes that have none."
    )
    console.print(
        f"{many['logs']} such logs on two cores: {many['seconds']:.1f} s (asked for: ten in ≤ "
        f"{TEN_LIMIT_S:g} s); both effects named in {many['both_named']}, "
        f"something more named in {many['with_more']}"
    )


@click.command()
@click.option("--json", "target", type=click.Path(path_type=Path), help="write the figures here too")
@click.option("--quick", is_flag=True, help="two logs of two minutes, to try the benchmark itself")
def main(target: Path | None, quick: bool) -> None:
    """Measure calibration and its peers."""
    console = Console(width=None if sys.stdout.isatty() else 140)
    try:
        figures = measure(quick)
    except ValueError as error:
        raise click.ClickException(str(error)) from None
    show(figures, console)
    if target is not None:
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(json.dumps(figures, indent=1, default=float) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
