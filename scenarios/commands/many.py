"""Commands of many runs: campaign, paper, objective."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click


@click.command(short_help="Run many variations of a scenario, with one report.")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), help="Output folder (default: out/<campaign>).")
@click.option("--jobs", type=click.IntRange(min=1), help="Processes on this machine (default: one per core).")
@click.option(
    "--scheduler", metavar="tcp://HOST:PORT", help="A Dask scheduler instead: pip install 'schmidt[cluster]'."
)
@click.option("--resume", is_flag=True, help="Go on with what is in the folder.")
def campaign(file: Path, out: Path | None, jobs: int | None, scheduler: str | None, resume: bool) -> None:
    """Run many variations of one scenario and report on all of them (exit 0: every run was made)."""
    from scenarios.campaign.command import campaign as command

    sys.exit(command(file, out if out is not None else Path("out") / file.stem, jobs, scheduler, resume))


@click.command(short_help="Repeat the paper's experiments.")
@click.option("--json", "json_file", type=click.Path(path_type=Path), help="Write the rows to this file.")
@click.option("--out", type=click.Path(path_type=Path), default=Path("out/paper"), show_default=True)
@click.option("--plant", type=click.Path(path_type=Path), help="Plant file with low preload.")
@click.option("--plant-high", type=click.Path(path_type=Path), help="Plant file with high preload.")
@click.option(
    "--reading",
    type=click.Choice(["motor", "printed"]),
    default="motor",
    show_default=True,
    help="Torques of Table 2: N mm at the motor, or N m at the axis as printed.",
)
@click.option("--markdown", type=click.Path(path_type=Path), help="Write the table to this file.")
@click.option("--rows", metavar="E1,E2,...", help="These rows only, by their names.")
@click.option("--quick", is_flag=True, help="Two starts instead of eight; decides nothing.")
@click.option("--every", is_flag=True, help="Every start angle with every seed: 24 starts instead of eight.")
@click.option("--jobs", type=click.IntRange(min=1), help="Processes on this machine (default: one per core).")
@click.option("--scheduler", metavar="tcp://HOST:PORT", help="A Dask scheduler instead.")
def paper(
    json_file: Path | None,
    out: Path,
    plant: Path | None,
    plant_high: Path | None,
    reading: str,
    markdown: Path | None,
    rows: str | None,
    quick: bool,
    every: bool,
    jobs: int | None,
    scheduler: str | None,
) -> None:
    """Repeat the paper's experiments from eight starts: published against emulated (exit 1 when a row is
    missed)."""
    from scenarios.paper.command import paper as command

    where: dict[str, Any] = {"jobs": jobs, "scheduler": scheduler, "reading": reading}
    sys.exit(
        command(json_file, out, plant, plant_high, markdown, names=rows, quick=quick, every=every, **where)
    )


@click.command(short_help="Hold 15 arcsec/s from many starts and measure the rate.")
@click.option("--out", type=click.Path(path_type=Path), default=Path("out/objective"), show_default=True)
@click.option(
    "--plant",
    default="low_preload_motor_units",
    show_default=True,
    help="Plant with low preload: a file or a name.",
)
@click.option(
    "--plant-high",
    default="high_preload_motor_units",
    show_default=True,
    help="Plant with high preload: a file or a name.",
)
@click.option(
    "--compensation", type=click.Path(path_type=Path), help="A compensation.yaml of schmidt calibrate."
)
@click.option(
    "--starts", type=click.IntRange(1, 64), default=8, show_default=True, help="Number of start angles."
)
@click.option(
    "--seeds", type=click.IntRange(1, 16), default=3, show_default=True, help="Seeds, taken in turn."
)
@click.option(
    "--shift", type=float, default=0.0, show_default=True, help="Added to all start angles, degrees."
)
@click.option(
    "--seconds", type=click.FloatRange(min=1), default=600.0, show_default=True, help="Length of each run."
)
@click.option("--only", help="Only rows whose name contains this.")
@click.option("--steps", is_flag=True, help="The firmware's changes one after the other instead.")
def objective(
    out: Path,
    plant: str,
    plant_high: str,
    compensation: Path | None,
    starts: int,
    seeds: int,
    shift: float,
    seconds: float,
    only: str | None,
    steps: bool,
) -> None:
    """Hold 15 arcsec/s from many starts; print by how much the true rate errs (exit 1: a row is missed)."""
    from scenarios.objective.command import objective as command

    sys.exit(command(out, plant, plant_high, compensation, starts, seeds, shift, seconds, only, steps))
