"""`schmidt run`: one scenario."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from scenarios.commands.endings import INTERRUPTED, UNUSABLE, fail
from scenarios.commands.options import NETWORK, SECONDS, SEED, SPEED, Number, feeding

if TYPE_CHECKING:
    from plant.model import PlantModel
    from scenarios.model import Scenario
    from scenarios.run import Result


@click.command(short_help="Run a scenario and judge it.")
@click.argument("scenario", type=click.Path(path_type=Path), required=False)
@click.option("--out", type=click.Path(path_type=Path), help="Output folder (default: out/<scenario>).")
@click.option("--seed", type=SEED, help="Another seed than the scenario's.")
@click.option("--plant", help="Another plant file, or the name of one that comes with schmidt.")
@click.option(
    "--speed",
    type=SPEED,
    help="Times real time (default: as fast as it goes).",
)
@click.option("--log-rate", type=Number(0.01, 20), help="Lines per second of the status and sensor logs.")
@click.option("--network", type=NETWORK, help="Which boards: the lab's 11, the 5 with RS232, or all 18.")
@click.option(
    "--firmware",
    type=click.Choice(["paper", "fine"]),
    help="Firmware of the axis boards: the paper's, or docs/one-arcsecond.md's.",
)
@click.option(
    "--compensation",
    type=click.Path(path_type=Path),
    help="Load this table of schmidt calibrate; runs three times: without it, with it wrong, with it.",
)
@click.option("--no-report", is_flag=True, help="Logs and summary.json only, no figures: ends sooner.")
@click.option("--mute", metavar="BOARD", help="This board sends nothing; its frames come from --feed.")
@click.option(
    "--feed", type=click.Path(path_type=Path), metavar="LOG", help="Log to take them from (candump -L)."
)
@click.option(
    "--snapshot-at", type=SECONDS, metavar="SECONDS", help="Take a snapshot at this simulated time."
)
@click.option(
    "--snapshot", type=click.Path(path_type=Path), help="File of the snapshot (default: OUT/snapshot)."
)
@click.option(
    "--from", "begun", type=click.Path(path_type=Path), help="Go on from this snapshot; takes no SCENARIO."
)
def run(
    scenario: Path | None,
    out: Path | None,
    seed: int | None,
    plant: str | None,
    speed: float | None,
    log_rate: float | None,
    network: str | None,
    firmware: str | None,
    compensation: Path | None,
    no_report: bool,
    mute: str | None,
    feed: Path | None,
    snapshot_at: float | None,
    snapshot: Path | None,
    begun: Path | None,
) -> None:
    """Run SCENARIO and say whether its expectations hold (exit 0: all, 1: not all, 2: unusable input)."""
    whole = order = None
    muted = feeding(mute, feed)
    if begun is not None or snapshot_at is not None:
        from scenarios.native.finder import plain

        plain()  # compiled instances cannot be taken apart; the source gives the same bits
    if begun is not None:
        from scenarios.snapshot.run import begun as read
        from scenarios.snapshot.run import parts

        if scenario or seed is not None or plant or network or firmware or compensation or log_rate:
            raise click.UsageError("--from goes on with what is in the snapshot, nothing else")
        whole = read(begun)
        scenario = parts(whole)[0].file
    elif scenario is None:
        raise click.UsageError("Missing argument 'SCENARIO'.")
    from scenarios import run as runner

    folder = out if out is not None else Path("out") / scenario.stem
    if snapshot_at is not None:
        from scenarios.snapshot.run import Order

        order = Order(round(snapshot_at * 1e9), snapshot or folder / "snapshot")
    if compensation is not None:
        firmware = firmware or "fine"  # a table in fractions of a step wants a duty in fractions of a step
    period_s = 1.0 / log_rate if log_rate else None
    if whole is not None:
        loaded, model = parts(whole)
    else:
        loaded, model = runner.prepare(scenario, seed, plant, speed, period_s, firmware, network)
    if compensation is not None:
        if order is not None:
            raise click.UsageError("--snapshot-at and --compensation do not go together: that is three runs")
        result = _compared(loaded, model, folder, compensation)
    else:
        with runner.bar(loaded, sys.stderr.isatty()) as progress:
            result = runner.run(loaded, model, folder, progress, not no_report, order, whole, muted)
        if order is not None and not order.done:
            fail(f"the run ended before {snapshot_at:g} s: no snapshot", UNUSABLE)
    _tell(result, folder, no_report)
    if muted is not None:
        from bus.protocol import device_named
        from scenarios.muted import compare

        click.echo(compare(muted[1], folder / "can.log", int(device_named(muted[0]))).text())
    if result.interrupted:
        fail(f"interrupted, logs up to t={result.summary['simulated_s']:.1f} s in {folder}", INTERRUPTED)
    sys.exit(0 if result.passed else 1)


def _compared(loaded: Scenario, model: PlantModel, folder: Path, file: Path) -> Result:
    from scenarios import compared
    from scenarios import compensation as tables
    from scenarios import run as runner

    table = tables.load(file)
    result, gains = compared.run(
        loaded, model, folder, table, lambda each: runner.bar(each, sys.stderr.isatty())
    )
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
