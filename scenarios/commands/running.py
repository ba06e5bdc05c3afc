"""`schmidt run`: one scenario."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from scenarios.commands.endings import INTERRUPTED, UNUSABLE, fail
from scenarios.commands.options import PATH, SECONDS, SEED, SPEED, Number, filled, muting, network
from scenarios.commands.parts import need

if TYPE_CHECKING:
    from plant.model import PlantModel
    from scenarios.language.model import Scenario
    from scenarios.run.run import Result


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """What the command line says, as click has read it. speed: times real time. log_rate: lines a second."""

    scenario: Path | None
    out: Path | None
    seed: int | None
    plant: str | None
    speed: float | None
    log_rate: float | None
    network: str | None
    firmware: str | None
    compensation: Path | None
    no_report: bool
    isolated: bool
    muted: tuple[str, Path] | None
    snapshot_at: float | None
    snapshot: Path | None
    begun: Path | None

    @property
    def changed(self) -> bool:
        """Whether anything is said that a snapshot has settled."""
        words = self.scenario, self.plant, self.network, self.firmware, self.compensation, self.log_rate
        return any(words) or self.isolated or self.seed is not None


@click.command(short_help="Run a scenario and judge it.")
@click.argument("scenario", type=PATH, required=False)
@click.option("--out", type=PATH, help="Output folder (default: out/<scenario>).")
@click.option("--seed", type=SEED, help="Another seed than the scenario's.")
@click.option("--plant", help="Another plant file, or the name of one that comes with schmidt.")
@click.option("--speed", type=SPEED, help="Times real time (default: as fast as it goes).")
@click.option("--log-rate", type=Number(0.01, 20), help="Lines per second of the status and sensor logs.")
@network
@click.option(
    "--firmware",
    type=click.Choice(["paper", "fine"]),
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
@filled(RunOptions)
def run(options: RunOptions) -> None:
    """Run SCENARIO and say whether its expectations hold (exit 0: all, 1: not all, 2: unusable input)."""
    muted = options.muted
    need("parquet", *(() if options.no_report else ("plots",)))
    if options.begun is not None or options.snapshot_at is not None:
        from scenarios.native.finder import plain

        plain()  # compiled instances cannot be taken apart; the source gives the same bits
    scenario, model, whole = _loaded(options)
    if scenario.can_log == "mf4":
        need("recordings")
    folder = options.out if options.out is not None else Path("out") / scenario.file.stem
    if options.compensation is not None:
        if options.snapshot_at is not None:
            raise click.UsageError("--snapshot-at and --compensation do not go together: that is three runs")
        result = _compared(scenario, model, folder, options.compensation)
    else:
        result = _once(scenario, model, folder, options, whole)
    _tell(result, folder, options.no_report)
    if muted is not None:
        from scenarios.lab.muted import compare
        from scenarios.lab.networks import devices_in

        board = next(device for device in devices_in(scenario) if device.name == muted[0])
        click.echo(compare(muted[1], folder / "can.log", board).text())
    if result.interrupted:
        fail(f"interrupted, logs up to t={result.summary['simulated_s']:.1f} s in {folder}", INTERRUPTED)
    sys.exit(0 if result.passed else 1)


def _loaded(options: RunOptions) -> tuple[Scenario, PlantModel, dict[str, Any] | None]:
    """Scenario, plant and the snapshot that a run goes on from (None: it starts)."""
    from scenarios.lab.prepare import Changes, prepare

    if options.begun is not None:
        from scenarios.lab.snapshot.run import begun

        if options.changed:
            raise click.UsageError("--from goes on with what is in the snapshot, nothing else")
        whole = begun(options.begun)
        return whole["scenario"], whole["model"], whole
    if options.scenario is None:
        raise click.UsageError("Missing argument 'SCENARIO'.")
    # a table in fractions of a step wants a duty in fractions of a step
    firmware = options.firmware or (None if options.compensation is None else "fine")
    changes = Changes(
        seed=options.seed,
        plant=options.plant,
        speed=options.speed,
        status_period_s=1.0 / options.log_rate if options.log_rate else None,
        firmware=firmware,
        network=options.network,
        isolated=options.isolated,
    )
    return *prepare(options.scenario, changes), None


def _once(
    scenario: Scenario,
    model: PlantModel,
    folder: Path,
    options: RunOptions,
    whole: dict[str, Any] | None,
) -> Result:
    from scenarios.lab.snapshot.run import Order
    from scenarios.run import run as runner

    order = None
    if options.snapshot_at is not None:
        order = Order(round(options.snapshot_at * 1e9), options.snapshot or folder / "snapshot")
    way = runner.Way(report=not options.no_report, snapshot=order, begun=whole, mute=options.muted)
    with runner.bar(scenario) as progress:
        result = runner.run(scenario, model, folder, progress, way)
    if order is not None and not order.done:
        fail(f"the run ended before {options.snapshot_at:g} s: no snapshot", UNUSABLE)
    return result


def _compared(scenario: Scenario, model: PlantModel, folder: Path, file: Path) -> Result:
    from scenarios.language import compensation as tables
    from scenarios.run import compared
    from scenarios.run import run as runner

    table = tables.load(file)
    result, gains = compared.run(scenario, model, folder, table, runner.bar)
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
