"""Commands of many runs: campaign, paper, objective."""

import sys
from pathlib import Path
from typing import Any

import click

from scenarios.commands.options import PATH, Number
from scenarios.commands.parts import need
from scenarios.studies.options import HIGH, LOW, ObjectiveOptions, PaperOptions

_jobs = click.option(
    "--jobs", type=click.IntRange(1, 1024), help="Processes on this machine (default: one per core)."
)
_scheduler = click.option(
    "--scheduler", metavar="tcp://HOST:PORT", help="A Dask scheduler instead (the extra cluster)."
)
_low = click.option("--plant", default=LOW, help="Plant with low preload: a file or a name.")
_high = click.option("--plant-high", default=HIGH, help="Plant with high preload: a file or a name.")


@click.command(short_help="Run many variations of a scenario, with one report.")
@click.argument("file", type=PATH)
@click.option("--out", type=PATH, help="Output folder (default: out/<campaign>).")
@_jobs
@_scheduler
@click.option("--resume", is_flag=True, help="Go on with what is in the folder.")
def campaign(scheduler: str | None, **given: Any) -> None:
    """Run many variations of one scenario and report on all of them (exit 0: every run was made)."""
    need("calibrate", *(("cluster",) if scheduler else ()))
    from scenarios.campaign.run_campaign import CampaignOptions
    from scenarios.campaign.run_campaign import campaign as command

    sys.exit(command(CampaignOptions(scheduler=scheduler, **given)))


@click.command(short_help="Repeat the paper's experiments.")
@click.option("--json", "json_file", type=PATH, help="Write the rows to this file.")
@click.option("--out", type=PATH, default=Path("out/paper"))
@_low
@_high
@click.option("--rows", metavar="E1,E2,...", help="These rows only, by their names.")
@click.option("--quick", is_flag=True, help="Two starts instead of eight; decides nothing.")
@click.option(
    "--others", type=click.IntRange(0, 1000), default=0, help="Starts and seeds that no search used."
)
@click.option(
    "--vary", type=Number(0, 50), default=0.0, help="J, K, R, Tc, Ts off by so many percent, in turn."
)
@_jobs
@_scheduler
def paper(**given: Any) -> None:
    """Repeat the paper's experiments from eight starts: published against emulated (exit 1: a row missed)."""
    options = PaperOptions(**given)
    need("calibrate", *(("cluster",) if options.scheduler else ()))
    from scenarios.studies.paper.run_experiments import paper as command

    sys.exit(command(options))


@click.command(short_help="Hold 15 arcsec/s from many starts and measure the rate.")
@click.option("--out", type=PATH, default=Path("out/objective"))
@_low
@_high
@click.option("--compensation", type=PATH, help="A compensation.yaml of schmidt calibrate.")
@click.option("--starts", type=click.IntRange(1, 64), default=8, help="Number of start angles.")
@click.option("--seeds", type=click.IntRange(1, 16), default=3, help="Seeds, taken in turn.")
@click.option("--shift", type=Number(-360, 360), default=0.0, help="Added to all start angles, degrees.")
@click.option("--seconds", type=Number(1, 1e6), default=600.0, help="Length of each run.")
@click.option("--only", help="Only rows whose name contains this.")
@click.option("--steps", is_flag=True, help="The firmware's changes one after the other instead.")
def objective(**given: Any) -> None:
    """Hold 15 arcsec/s from many starts; print by how much the true rate errs (exit 1: a row is missed)."""
    need("calibrate")
    from scenarios.studies.objective.run_holds import objective as command

    sys.exit(command(ObjectiveOptions(**given)))
