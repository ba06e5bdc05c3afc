"""`schmidt run`: one scenario."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from scenarios.campaign.options import CampaignOptions
from scenarios.options import (
    INTERRUPTED,
    PATH,
    SECONDS,
    SEED,
    SPEED,
    UNUSABLE,
    Number,
    fail,
    filled,
    muting,
    need,
    network,
)
from scenarios.studies.options import ObjectiveOptions, PaperOptions

if TYPE_CHECKING:
    from plant.model import PlantModel
    from scenarios.language.model import Scenario
    from scenarios.run.run import Result


@click.command(short_help="Run a scenario and judge it.")
@click.argument("scenario", type=PATH, required=False)
@click.option("--out", type=PATH, help="Output folder (default: out/<scenario>).")
@click.option("--seed", type=SEED, help="Another seed than the scenario's.")
@click.option("--plant", help="Another plant file, or the name of one that comes with schmidt.")
@click.option("--speed", type=SPEED, help="Times real time (default: as fast as it goes).")
@click.option(
    "--log-rate",
    "status_period_s",
    type=Number(0.01, 20),
    callback=lambda _context, _option, rate: rate and 1.0 / rate,
    help="Lines per second of the status and sensor logs.",
)
@network
@click.option(
    "--firmware",
    type=click.Choice(["paper", "fine", "observer"]),
    help="Firmware of the axis boards: the paper's, or docs/results/one-arcsecond.md's.",
)
@click.option(
    "--compensation",
    type=PATH,
    help="Load this table of schmidt calibrate; runs three times: without it, with it wrong, with it.",
)
@click.option("--no-report", is_flag=True, help="Logs and summary.json only, no figures: ends sooner.")
@click.option("--isolated", is_flag=True, help="Firmware in C runs in processes of its own.")
@muting
@click.option(
    "--snapshot-at", type=SECONDS, metavar="SECONDS", help="Take a snapshot at this simulated time."
)
@click.option("--snapshot", type=PATH, help="File of the snapshot (default: OUT/snapshot).")
@click.option("--from", "begun", type=PATH, help="Go on from this snapshot; takes no SCENARIO.")
def run(
    scenario: Path | None,
    out: Path | None,
    compensation: Path | None,
    no_report: bool,
    muted: tuple[str, Path] | None,
    snapshot_at: float | None,
    snapshot: Path | None,
    begun: Path | None,
    **given: Any,
) -> None:
    """Run SCENARIO and say whether its expectations hold (exit 0: all, 1: not all, 2: unusable input)."""
    need("parquet", *(() if no_report else ("plots",)))
    if begun is not None or snapshot_at is not None:
        from scenarios.native.finder import plain

        plain()  # compiled instances cannot be taken apart; the source gives the same bits
    from scenarios.lab.prepare import Changes, prepare
    from scenarios.lab.snapshot.run import Order
    from scenarios.lab.snapshot.run import begun as read_run
    from scenarios.run import run as runner

    if snapshot is not None and snapshot_at is None:
        raise click.UsageError("--snapshot FILE needs --snapshot-at SECONDS")
    changes, whole = Changes(**given), None
    if begun is not None:
        if scenario or compensation or changes != Changes():
            raise click.UsageError("--from goes on with what is in the snapshot, nothing else")
        whole = read_run(begun)
        found, model = whole["scenario"], whole["model"]
    elif scenario is None:
        raise click.UsageError("Missing argument 'SCENARIO'.")
    else:
        if compensation is not None and changes.firmware is None:
            changes = replace(changes, firmware="fine")  # its fractions of a step want a duty in fractions
        found, model = prepare(scenario, changes)
    if found.can_log == "mf4":
        need("recordings")
    folder = out if out is not None else Path("out") / found.file.stem
    order = None
    if snapshot_at is not None:
        order = Order(round(snapshot_at * 1e9), snapshot or folder / "snapshot")
    if compensation is not None:
        if order is not None:
            raise click.UsageError("--snapshot-at and --compensation do not go together: that is three runs")
        result = _compared(found, model, folder, compensation)
    else:
        way = runner.Way(report=not no_report, snapshot=order, begun=whole, mute=muted)
        with runner.bar(found) as progress:
            result = runner.run(found, model, folder, progress, way)
        if order is not None and not order.done:
            fail(f"the run ended before {snapshot_at:g} s: no snapshot", UNUSABLE)
    _tell(result, folder, no_report)
    if muted is not None:
        from scenarios.lab.muted import compare
        from scenarios.lab.networks import devices_in

        board = next(device for device in devices_in(found) if device.name == muted[0])
        click.echo(compare(muted[1], folder / "can.log", board).text())
    if result.interrupted:
        fail(f"interrupted, logs up to t={result.summary['simulated_s']:.1f} s in {folder}", INTERRUPTED)
    sys.exit(0 if result.passed else 1)


def _compared(scenario: Scenario, model: PlantModel, folder: Path, file: Path) -> Result:
    from scenarios.language.configure import load_compensation
    from scenarios.run import compared
    from scenarios.run import run as runner

    result, gains = compared.run(scenario, model, folder, load_compensation(file), runner.bar)
    for text in compared.lines(gains):
        click.echo(text)
    return result


def _tell(result: Result, folder: Path, no_report: bool) -> None:
    """A line a verdict, then the run's own."""
    for verdict in result.verdicts:
        sign, limit = ("≤" if verdict.upper else "≥"), f"{verdict.limit:g}"
        value = "no value" if verdict.value is None else f"{verdict.value:.4g}"
        unit = "" if verdict.unit == "1" else f" {verdict.unit}"
        reason = f"  ({verdict.reason})" if verdict.reason else ""
        click.echo(
            f"{'ok  ' if verdict.passed else 'MISS'} {verdict.name}: {value} {sign} {limit}{unit}{reason}"
        )
    summary = result.summary
    click.echo(
        f"{summary['simulated_s']:.1f} s simulated at {summary['real_time_factor']:.1f} times real time, "
        f"digest {summary['trace_digest'][:16]}, "
        + (f"logs in {folder}" if no_report else f"report {folder / 'report.html'}")
    )


@click.command(short_help="Run many variations of a scenario, with one report.")
@filled(CampaignOptions)
def campaign(options: CampaignOptions) -> None:
    """Run many variations of one scenario and report on all of them (exit 0: every run was made)."""
    need("calibrate", *(("cluster",) if options.scheduler else ()))
    from scenarios.campaign.run_campaign import campaign as command

    sys.exit(command(options))


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
