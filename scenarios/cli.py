"""The command `schmidt`. Commands import what they need when they are called, so that it starts at once."""

from __future__ import annotations

import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import click

if TYPE_CHECKING:
    from plant.model import PlantModel
    from scenarios.model import Scenario
    from scenarios.run import Result

UNUSABLE = 2
INTERRUPTED = 130
_LINE = 600
"""Longer messages quote somebody's megabyte."""


class Number(click.FloatRange):
    """A range that nan is not in: it passes every comparison of click's."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number, or click's own error."""
        number = super().convert(value, param, ctx)
        if number != number:
            self.fail(f"{value} is no number", param, ctx)
        return number


SPEED = Number(0.01, 1000)
"""`bus.pacer` has the same bounds; not imported here, so that the command starts at once."""
SEED = click.IntRange(0, 2**63 - 1)
SECONDS = Number(min=0, min_open=True, max=1e7)
NETWORK = click.Choice(["lab", "serial", "final"])
"""`scenarios/networks.py` has the same; not imported here, for the same reason."""


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="schmidt", prog_name="schmidt")
def cli() -> None:
    """Emulator of the 50/80 cm Schmidt telescope's microcontroller network, and its calibration."""


@cli.command(short_help="Run a scenario and judge it.")
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
    muted = _muted(mute, feed)
    if begun is not None or snapshot_at is not None:
        from scenarios.native.finder import plain

        plain()  # compiled instances cannot be taken apart; the source gives the same bits
    if begun is not None:
        from scenarios.snapshot.run import parts, read

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
            _fail(f"the run ended before {snapshot_at:g} s: no snapshot", UNUSABLE)
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
    if muted is not None:
        from bus.protocol import device_named
        from scenarios.muted import compare

        click.echo(compare(muted[1], folder / "can.log", int(device_named(muted[0]))).text())
    if result.interrupted:
        _fail(f"interrupted, logs up to t={summary['simulated_s']:.1f} s in {folder}", INTERRUPTED)
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


@cli.command(short_help="Repeat the paper's experiments.")
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


@cli.command(short_help="Hold 15 arcsec/s from many starts and measure the rate.")
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


def _muted(mute: str | None, feed: Path | None) -> tuple[str, Path] | None:
    """A board and the log its frames come from; raises UsageError for one without the other."""
    if (mute is None) != (feed is None):
        raise click.UsageError("--mute BOARD and --feed LOG go together")
    return None if mute is None or feed is None else (mute, feed)


@cli.command(short_help="Run the boards in real time and open doors to them.")
@click.argument("scenario", type=click.Path(path_type=Path), required=False)
@click.option(
    "--can",
    multiple=True,
    metavar="INTERFACE:CHANNEL",
    help="The CAN bus, such as socketcan:vcan0; repeatable.",
)
@click.option(
    "--serial",
    multiple=True,
    metavar="pty:DIR|tcp:PORT|rfc2217:PORT",
    help="The five RS232 lines: pseudo-terminals named in DIR, or five TCP ports from PORT on.",
)
@click.option(
    "--hid", multiple=True, metavar="uhid|unix:PATH", help="The gateway's USB: /dev/hidrawN, or a socket."
)
@click.option(
    "--lx200",
    multiple=True,
    metavar="[HOST:]PORT|pty:NAME",
    help="LX200, for Stellarium and INDI; repeatable.",
)
@click.option("--alpaca", metavar="[HOST:]PORT", help="ASCOM Alpaca telescope and focuser, with discovery.")
@click.option("--console", metavar="[HOST:]PORT", help="The consoles, for a browser.")
@click.option(
    "--runs",
    type=click.Path(path_type=Path),
    default=Path("out/console"),
    show_default=True,
    help="Folder of the runs recorded on the console.",
)
@click.option("--logs", type=click.Path(path_type=Path), help="Folder of the host's four logs.")
@click.option("--control", metavar="[HOST:]PORT", help="Speed, pause, status, stop (see schmidt control).")
@click.option("--token", help="Word that clients of other machines must know (default: made up, printed).")
@click.option("--speed", type=SPEED, default=1.0, show_default=True, help="Times real time.")
@click.option("--seed", type=SEED, help="Another seed than the scenario's.")
@click.option("--plant", help="Plant file, or the name of one that comes with schmidt.")
@click.option("--duration", type=SECONDS, help="End after this many seconds.")
@click.option("--debug", metavar="DIR", help="Every board's debug port as a pseudo-terminal in DIR (slcan).")
@click.option("--network", type=NETWORK, help="Which boards: the lab's 11, the 5 with RS232, or all 18.")
@click.option("--mute", metavar="BOARD", help="This board sends nothing; its frames come from --feed.")
@click.option(
    "--feed", type=click.Path(path_type=Path), metavar="LOG", help="Log to take them from (candump -L)."
)
@click.option("--record", type=click.Path(path_type=Path), help="Record the session in this folder.")
def serve(
    scenario: Path | None,
    can: tuple[str, ...],
    serial: tuple[str, ...],
    hid: tuple[str, ...],
    lx200: tuple[str, ...],
    alpaca: str | None,
    console: str | None,
    runs: Path,
    logs: Path | None,
    control: str | None,
    token: str | None,
    speed: float,
    seed: int | None,
    plant: str | None,
    duration: float | None,
    debug: str | None,
    network: str | None,
    mute: str | None,
    feed: Path | None,
    record: Path | None,
) -> None:
    """Pace the network in real time and open its doors; its boards answer to anyone."""
    from scenarios.doors.options import DoorOptions
    from scenarios.serve import serve as command

    options = DoorOptions(can, serial, hid, control, token, lx200, alpaca, logs, console, runs, debug)
    muted = _muted(mute, feed)
    sys.exit(command(scenario, options, speed, seed, plant, duration, record, network, muted))


@cli.command(short_help="The host program alone, on the boards' cables.")
@click.argument("scenario", type=click.Path(path_type=Path), required=False)
@click.option("--usb", required=True, metavar="/dev/hidrawN|unix:PATH|can:SPEC", help="Where the gateway is.")
@click.option(
    "--serial", multiple=True, metavar="BOARD=PORT", help="RS232 of a board, such as AXIS_RA=/dev/ttyS0."
)
@click.option(
    "--lx200",
    multiple=True,
    metavar="[HOST:]PORT|pty:NAME",
    help="LX200, for Stellarium and INDI; repeatable.",
)
@click.option("--alpaca", metavar="[HOST:]PORT", help="ASCOM Alpaca telescope and focuser, with discovery.")
@click.option("--console", metavar="[HOST:]PORT", help="The consoles, for a browser.")
@click.option(
    "--runs",
    type=click.Path(path_type=Path),
    default=Path("out/console"),
    show_default=True,
    help="Folder of the runs recorded on the console.",
)
@click.option("--token", help="Word that browsers of other machines must know (default: made up, printed).")
@click.option("--network", type=NETWORK, help="Which boards: the lab's 11, the 5 with RS232, or all 18.")
@click.option("--logs", type=click.Path(path_type=Path), help="Folder of the four logs.")
@click.option("--duration", type=SECONDS, help="End after this many seconds.")
def host(
    scenario: Path | None,
    usb: str,
    serial: tuple[str, ...],
    lx200: tuple[str, ...],
    alpaca: str | None,
    console: str | None,
    runs: Path,
    token: str | None,
    network: str | None,
    logs: Path | None,
    duration: float | None,
) -> None:
    """The host program by itself, on the boards' cables; SCENARIO gives site, mount and date."""
    from scenarios.doors.options import DoorOptions
    from scenarios.host import command

    options = DoorOptions(lx200=lx200, alpaca=alpaca, logs=logs, console=console, runs=runs, token=token)
    sys.exit(command(scenario, usb, serial, options, duration, network))


@cli.command(short_help="Repeat a session that serve --record has left.")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), help="Output folder (default: FOLDER-replayed).")
def replay(folder: Path, out: Path | None) -> None:
    """Run a session again that serve --record left in FOLDER (exit 0: to the same digest)."""
    from scenarios.doors.replay import replay as command

    again, before = command(folder, out or folder.with_name(folder.name + "-replayed"))
    same = "" if before is None else " as recorded" if again == before else f", recorded was {before[:16]}"
    click.echo(f"digest {again[:16]}{same}")
    sys.exit(0 if before in (None, again) else 1)


@cli.command(short_help="Speed, pause, faults, supply, end of a served network.")
@click.argument("command", nargs=-1, required=True)
@click.option(
    "--at",
    default="127.0.0.1:7411",
    show_default=True,
    metavar="[HOST:]PORT",
    help="Where serve --control listens.",
)
@click.option("--token", help="The word serve has printed; for other machines.")
def control(command: tuple[str, ...], at: str, token: str | None) -> None:
    """Tell a served network: status, speed X, pause, resume, power BOARD on|off, stop,
    fault list, fault start NAME [ARGUMENT=VALUE...], fault clear NUMBER (docs/faults.md).
    """
    from scenarios.doors.tell import tell

    click.echo(tell(" ".join(command), at, token))


@cli.command(short_help="Run many variations of a scenario, with one report.")
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


@cli.command(short_help="Name what the model lacks in measured logs.")
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


@cli.command(short_help="Show what is understood of a rig file and its logs.")
@click.argument("file", type=click.Path(path_type=Path))
@click.argument("logs", nargs=-1, type=click.Path(path_type=Path))
@click.option("--plot", type=click.Path(path_type=Path), help="Write a PNG of all columns.")
def rig(file: Path, logs: tuple[Path, ...], plot: Path | None) -> None:
    """Show what is understood of a rig FILE and its LOGS, before anything is fitted."""
    from calibration.command import show_rig

    click.echo(show_rig(file, list(logs), plot))


@cli.command(short_help="Check boards, emulated or real, against the protocol.")
@click.argument("scenario", type=click.Path(path_type=Path), required=False)
@click.option("--network", type=NETWORK, help="Which boards: the lab's 11, the 5 with RS232, or all 18.")
@click.option(
    "--can",
    "channel",
    metavar="INTERFACE:CHANNEL",
    help="Where the boards are, such as socketcan:can0. Without it: the emulated network in this process.",
)
@click.option("--json", "json_file", type=click.Path(path_type=Path), help="Write the results to this file.")
@click.option("--speed", type=SPEED, default=1.0, show_default=True, help="Speed the boards are served at.")
@click.option(
    "--tolerance",
    type=Number(min=0, max=1, min_open=True),
    default=0.02,
    show_default=True,
    help="Allowed error of a message's mean period, relative.",
)
@click.option(
    "--stamps",
    type=Number(min=0),
    default=0.001,
    show_default=True,
    help="Uncertainty of the tester's time stamps, seconds (in process: 0).",
)
@click.option("--board", "boards", multiple=True, metavar="TYPE:ID", help="Check this one only (repeatable).")
@click.option(
    "--motion/--no-motion", help="Send commands that move the telescope, too; it is stopped at the end."
)
@click.option("--flood", is_flag=True, help="Fill the bus, too: boards will report what they had to drop.")
def conformance(
    scenario: Path | None,
    network: str | None,
    channel: str | None,
    json_file: Path | None,
    speed: float,
    tolerance: float,
    stamps: float,
    boards: tuple[str, ...],
    motion: bool,
    flood: bool,
) -> None:
    """Check boards, emulated or real, against the protocol; SCENARIO or --network says which boards."""
    from bus.conformance import Settings
    from scenarios.conformance import command

    settings = Settings(period_tolerance=tolerance, stamps_s=stamps, speed=speed, motion=motion, flood=flood)
    sys.exit(command(channel, json_file, boards, settings, scenario, network))


@cli.command(short_help="Write CANopen data sheets of the boards.")
@click.argument("folder", type=click.Path(path_type=Path))
@click.argument("scenario", type=click.Path(path_type=Path), required=False)
@click.option("--network", type=NETWORK, help="Which boards: the lab's 11, the 5 with RS232, or all 18.")
def eds(folder: Path, scenario: Path | None, network: str | None) -> None:
    """Write a CANopen data sheet (EDS) per type of board into FOLDER; SCENARIO or --network says which
    boards, those of one's own too."""
    from scenarios.canopen import write_eds

    for file in write_eds(folder, scenario, network):
        click.echo(file)


@cli.command()
def protocol() -> None:
    """Print the protocol page, made from the DBC."""
    from bus.protocol.page import page

    click.echo(page())


@cli.command()
@click.argument("name", required=False)
def effects(name: str | None) -> None:
    """List the catalogue of effects, or describe one."""
    from plant.effects import REGISTRY

    if name is not None:
        if name not in REGISTRY:
            from scenarios.validate import nearest

            raise ValueError(f"no effect is called {name!r}; {nearest(name, REGISTRY)}")
        effect = REGISTRY[name]
        click.echo(f"{effect.name}: {effect.equation}\nchannel {effect.channel}, seen over {effect.domain}")
        if effect.stages:
            click.echo(f"stages: {', '.join(effect.stages)}")
        for each in effect.parameters:
            click.echo(
                f"  {each.name}: {each.default:g} {each.unit}, {each.low:g}..{each.high:g}; {each.source}"
            )
        return
    for effect in REGISTRY.values():
        click.echo(f"{effect.name:22} {effect.channel}  {effect.domain:12} {effect.equation}")


def _fail(text: str, status: int) -> NoReturn:
    if len(text) > _LINE:
        text = text[: _LINE // 2] + " … " + text[-_LINE // 2 :]
    click.echo(f"schmidt: {text}".encode(errors="backslashreplace").replace(b"\0", b"\\0"), err=True)
    sys.exit(status)


def _terminate(_signal: int, _frame: object) -> None:
    raise KeyboardInterrupt


def main() -> None:
    """Run the command; whatever goes wrong is one line, never a traceback."""
    signal.signal(signal.SIGTERM, _terminate)
    try:
        cli.main(standalone_mode=False)
    except click.exceptions.Abort:
        _fail("interrupted", INTERRUPTED)
    except click.ClickException as error:
        _fail(" ".join(error.format_message().split()), UNUSABLE)
    except KeyboardInterrupt:
        _fail("interrupted", INTERRUPTED)
    except (ValueError, OSError) as error:
        _fail(" ".join(str(error).split()), UNUSABLE)
    except ImportError as error:
        _fail(f"this command needs a part that is not installed: {error}", UNUSABLE)
    except MemoryError:
        _fail("there is not enough memory for this", UNUSABLE)
    except RecursionError:
        _fail("the input is nested too deeply", UNUSABLE)
    except Exception as error:
        _fail(f"internal error, please report it: {type(error).__name__}: {' '.join(str(error).split())}", 70)
