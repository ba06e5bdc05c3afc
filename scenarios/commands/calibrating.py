"""Commands on measured logs: calibrate, rig."""

import sys
from pathlib import Path

import click

from scenarios.commands.options import PATH
from scenarios.commands.parts import need

BEGIN_S, PER_MEGABYTE_S = 3.0, 5.0
"""Usual time of a calibration: 3.7 MB of an axis log take 16 to 19 s (docs/results/speed.md)."""


@click.command(short_help="Name what the model lacks in measured logs.")
@click.argument("logs", nargs=-1, required=True, type=PATH)
@click.option("--rig", type=PATH, help="Rig file that describes another drive (docs/reference/rigs.md).")
@click.option(
    "--hold-out",
    multiple=True,
    help="Name of a run that is not fitted to, only tested on (repeatable; default: chosen).",
)
@click.option("--plant", type=PATH, help="Plant file that the drive is declared by (axis logs).")
@click.option("--out", type=PATH, required=True, help="Output folder.")
def calibrate(
    logs: tuple[Path, ...], rig: Path | None, hold_out: tuple[str, ...], plant: Path | None, out: Path
) -> None:
    """Find what the model lacks in measured LOGS and write the corrected plant."""
    need("calibrate")
    from calibration.command import calibrate as command
    from scenarios.progress import stages

    megabytes = sum(log.stat().st_size for log in logs if log.is_file()) / 1e6
    usual_s = {f"{megabytes:.1f} MB of logs": BEGIN_S + PER_MEGABYTE_S * megabytes}
    # on a terminal the command's own line, which names its steps, stands below
    with stages("calibrating", usual_s, sys.stdout if sys.stdout.isatty() else None):
        status = command(list(logs), rig, list(hold_out), out, plant)
    sys.exit(status)


@click.command(short_help="Show what is understood of a rig file and its logs.")
@click.argument("file", type=PATH)
@click.argument("logs", nargs=-1, type=PATH)
@click.option("--plot", type=PATH, help="Write a PNG of all columns.")
@click.option(
    "--new", is_flag=True, help="FILE is a log: draft a rig file of it; what was guessed is marked."
)
def rig(file: Path, logs: tuple[Path, ...], plot: Path | None, new: bool) -> None:
    """Show what is understood of a rig FILE and its LOGS, before anything is fitted."""
    need("calibrate")
    from calibration.command import draft, show_rig

    if new and (logs or plot is not None):
        raise click.UsageError("--new drafts from one log, and draws nothing")
    click.echo(draft(file) if new else show_rig(file, list(logs), plot))
