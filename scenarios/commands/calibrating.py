"""Commands on measured logs: calibrate, rig."""

from __future__ import annotations

import sys
from pathlib import Path

import click


@click.command(short_help="Name what the model lacks in measured logs.")
@click.argument("logs", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "--rig", type=click.Path(path_type=Path), help="Rig file that describes another drive (docs/rigs.md)."
)
@click.option(
    "--hold-out",
    multiple=True,
    help="Name of a run that is not fitted to, only tested on (repeatable; default: chosen).",
)
@click.option(
    "--plant", type=click.Path(path_type=Path), help="Plant file that the drive is declared by (axis logs)."
)
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Output folder.")
def calibrate(
    logs: tuple[Path, ...], rig: Path | None, hold_out: tuple[str, ...], plant: Path | None, out: Path
) -> None:
    """Find what the model lacks in measured LOGS and write the corrected plant."""
    from calibration.command import calibrate as command

    sys.exit(command(list(logs), rig, list(hold_out), out, plant))


@click.command(short_help="Show what is understood of a rig file and its logs.")
@click.argument("file", type=click.Path(path_type=Path))
@click.argument("logs", nargs=-1, type=click.Path(path_type=Path))
@click.option("--plot", type=click.Path(path_type=Path), help="Write a PNG of all columns.")
def rig(file: Path, logs: tuple[Path, ...], plot: Path | None) -> None:
    """Show what is understood of a rig FILE and its LOGS, before anything is fitted."""
    from calibration.command import show_rig

    click.echo(show_rig(file, list(logs), plot))
