"""Commands of many runs: campaign, paper, objective."""

import sys
from typing import Any

import click

from scenarios.commands.parts import need
from scenarios.options import PATH, filled
from scenarios.studies.options import ObjectiveOptions, PaperOptions

_jobs = click.option(
    "--jobs", type=click.IntRange(1, 1024), help="Processes on this machine (default: one per core)."
)
_scheduler = click.option(
    "--scheduler", metavar="tcp://HOST:PORT", help="A Dask scheduler instead (the extra cluster)."
)


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
@filled(PaperOptions)
def paper(options: PaperOptions) -> None:
    """Repeat the paper's experiments from eight starts: published against emulated (exit 1: a row missed)."""
    need("calibrate", *(("cluster",) if options.scheduler else ()))
    from scenarios.studies.paper.run_experiments import paper as command

    sys.exit(command(options))


@click.command(short_help="Hold 15 arcsec/s from many starts and measure the rate.")
@filled(ObjectiveOptions)
def objective(options: ObjectiveOptions) -> None:
    """Hold 15 arcsec/s from many starts; print by how much the true rate errs (exit 1: a row is missed)."""
    need("calibrate")
    from scenarios.studies.objective.run_holds import objective as command

    sys.exit(command(options))
