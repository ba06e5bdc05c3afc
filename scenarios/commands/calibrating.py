"""Commands on measured logs: calibrate, rig."""

import sys
import warnings
from collections.abc import Sequence
from pathlib import Path

import click

from host.sky.pointread import is_run
from scenarios.options import PATH, need

READING, SEARCHING, REPLAYING, WRITING = "reading", "searching", "replaying", "writing the report"
USUAL = {READING: (0.4, 0.3), SEARCHING: (10.0, 2.8), REPLAYING: (0.3, 0.4), WRITING: (2.6, 0.4)}
"""Usual time of each stage: seconds, and seconds per megabyte of logs. Measured as processor time on
docs/example, on 2026-11-24; the pace of the machine at hand corrects the later ones."""
STEPS = {"running the closed loop again": REPLAYING, WRITING: WRITING}
"""Steps of the finder that begin a stage; all others are part of the search."""
RIG_S, RIG_PER_MEGABYTE_S = 2.0, 2.0


@click.command(short_help="Name what the model lacks in measured logs.")
@click.argument("logs", nargs=-1, required=True, type=PATH)
@click.option("--rig", type=PATH, help="Rig file that describes another drive (docs/reference/rigs.md).")
@click.option(
    "--hold-out",
    multiple=True,
    help="Name of a run that is not fitted to, only tested on (repeatable; default: chosen).",
)
@click.option("--plant", type=PATH, help="Plant file that the drive is declared by (axis logs).")
@click.option("--terms", metavar="IH,ID,...", help="Terms a mount is declared to have (pointing runs).")
@click.option("--out", type=PATH, required=True, help="Output folder.")
def calibrate(
    logs: tuple[Path, ...], rig: Path | None, hold_out: tuple[str, ...], plant: Path | None,
    terms: str | None, out: Path,
) -> None:  # fmt: skip
    """Find what the model lacks in measured LOGS and write the corrected plant.

    Of a pointing run (TPOINT's .dat, or CSV): the missing terms, and the model."""
    need("calibrate")
    if rig is None and any(is_run(log) for log in logs):
        from scenarios.commands.stars import calibrate_stars

        if len(logs) > 1 or hold_out or plant:
            raise click.UsageError("a pointing run is calibrated alone, with --terms and --out only")
        sys.exit(calibrate_stars(logs[0], terms, out))
    if terms is not None:
        raise click.UsageError("--terms is for a pointing run (docs/guides/pointing-model.md)")
    from numpy.linalg import LinAlgError

    from calibration.command import calibrate as command
    from scenarios.progress import stages

    size = megabytes(logs)
    usual_s = {name: begin_s + per_mb_s * size for name, (begin_s, per_mb_s) in USUAL.items()}
    with warnings.catch_warnings(), stages("calibrating", usual_s) as enter:
        warnings.simplefilter("ignore", RuntimeWarning)  # NumPy's, of columns that hold nothing
        try:
            status = command(
                list(logs), rig, list(hold_out), out, plant,
                on_step=lambda step: enter(STEPS.get(step, SEARCHING)),
            )  # fmt: skip
        except LinAlgError:
            raise ValueError(f"{logs[0]}: no fit converges; see scale and gain of the rig file") from None
    sys.exit(status)


def megabytes(logs: Sequence[Path]) -> float:
    """Size of the logs that are there."""
    return sum(log.stat().st_size for log in logs if log.is_file()) / 1e6


@click.command(short_help="Show what is understood of a rig file and its logs.")
@click.argument("file", type=PATH)
@click.argument("logs", nargs=-1, type=PATH)
@click.option("--plot", type=PATH, help="Write a PNG of all columns.")
@click.option(
    "--new", is_flag=True, help="FILE is a log: draft a rig file of it; what was guessed is marked."
)
@click.option("--rig", "named", type=PATH, help="The rig file, where FILE is the first of the logs.")
def rig(file: Path, logs: tuple[Path, ...], plot: Path | None, new: bool, named: Path | None) -> None:
    """Show what is understood of a rig FILE and its LOGS, before anything is fitted."""
    need("calibrate")
    from calibration.command import draft, show_rig
    from scenarios.progress import stages

    if named is not None:
        file, logs = named, (file, *logs)
    if new and (logs or plot is not None):
        raise click.UsageError("--new drafts from one log, and draws nothing")
    files = (file,) if new else logs
    with stages("reading", {f"{len(files)} file(s)": RIG_S + RIG_PER_MEGABYTE_S * megabytes(files)}):
        text = draft(file) if new else show_rig(file, list(logs), plot)
    click.echo(text)
