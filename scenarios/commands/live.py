"""Commands with real time, cables and clients: serve, control, replay, host."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

from scenarios.commands.options import PATH, SECONDS, SEED, SPEED, doors, muting, network, runs
from scenarios.commands.parts import need
from scenarios.doors.options import DoorOptions, HostOptions, ServeOptions
from scenarios.doors.table import ON_HOST, ON_NETWORK, asked


@click.command(short_help="Run the boards in real time and open doors to them.")
@click.argument("scenario", type=PATH, required=False)
@doors(*ON_NETWORK, *ON_HOST)
@runs
@click.option("--logs", type=PATH, help="Folder of the host's four logs and of its guide log.")
@click.option("--stars", type=PATH, help="The cameras' stars: a CSV with name, ra, dec, magnitude.")
@click.option("--frames", type=PATH, metavar="DIR", help="Folder for the cameras' frames as FITS files.")
@click.option("--token", help="Word that clients of other machines must know (default: made up, printed).")
@click.option("--speed", type=SPEED, default=1.0, help="Times real time.")
@click.option(
    "--clock",
    type=click.Choice(["wall", "steps"]),
    default="wall",
    help="steps: time stands until clients of --control step it.",
)
@click.option("--seed", type=SEED, help="Another seed than the scenario's.")
@click.option("--plant", help="Plant file, or the name of one that comes with schmidt.")
@click.option("--duration", type=SECONDS, help="End after this many seconds.")
@network
@muting
@click.option(
    "--realtime/--no-realtime",
    default=None,
    help="Run the ticks before all other programs (default: up to speed 1, where the system grants it).",
)
@click.option("--record", type=PATH, help="Record the session in this folder.")
@click.option(
    "--snapshots",
    type=PATH,
    metavar="DIR",
    help="Take snapshots into DIR when schmidt control asks for them; runs plain.",
)
@click.option("--from", "begun", type=PATH, help="Go on from this snapshot; takes no SCENARIO.")
def serve(**given: Any) -> None:
    """Pace the network in real time and open its doors; its boards answer to anyone."""
    options = ServeOptions(**given)
    need(*_extras(options), *(() if options.record is None else ("parquet",)))
    need(*(() if options.frames is None else ("camera",)))
    if options.snapshots is not None or options.begun is not None:
        from scenarios.native.finder import plain

        plain()  # as in run
    changed = options.scenario or options.seed is not None or options.plant or options.network
    if options.begun is not None and (changed or options.muted):
        raise click.UsageError("--from goes on with what is in the snapshot, nothing else")
    from scenarios.doors.serving import serve as command

    sys.exit(command(options))


def _extras(options: DoorOptions) -> Iterator[str]:
    """Extras that the doors on the host need."""
    return (kind.extra for kind, _ in asked(ON_HOST, options) if kind.extra)


@click.command(short_help="The host program alone, on the boards' cables.")
@click.argument("scenario", type=PATH, required=False)
@click.option("--usb", required=True, metavar="/dev/hidrawN|unix:PATH|can:SPEC", help="Where the gateway is.")
@click.option(
    "--serial", multiple=True, metavar="BOARD=PORT", help="RS232 of a board, such as AXIS_RA=/dev/ttyS0."
)
@doors(*ON_HOST)
@runs
@click.option("--token", help="Word that browsers of other machines must know (default: made up, printed).")
@network
@click.option("--logs", type=PATH, help="Folder of the four logs.")
@click.option("--duration", type=SECONDS, help="End after this many seconds.")
def host(**given: Any) -> None:
    """The host program by itself, on the boards' cables; SCENARIO gives site, mount and date."""
    options = HostOptions(**given)
    need(*_extras(options))
    from rich.console import Console

    from scenarios.doors.cabled_host import CabledHost

    CabledHost(options, Console()).run(options.duration)


@click.command(short_help="Repeat a session that serve --record has left.")
@click.argument("folder", type=PATH)
@click.option("--out", type=PATH, help="Output folder (default: FOLDER-replayed).")
@click.option("--from", "begun", type=PATH, help="Only what came after this snapshot of it.")
def replay(folder: Path, out: Path | None, begun: Path | None) -> None:
    """Run a session again that serve --record left in FOLDER (exit 0: to the same digest)."""
    if begun is not None or (folder / "begun.snapshot").exists():
        from scenarios.native.finder import plain

        plain()  # as in run
    from scenarios.doors.replay import replay as command
    from scenarios.doors.replay import replay_rest

    if begun is not None:
        again, before = replay_rest(folder, begun)
    else:
        again, before = command(folder, out or folder.with_name(folder.name + "-replayed"))
    same = "" if before is None else " as recorded" if again == before else f", recorded was {before[:16]}"
    click.echo(f"digest {again[:16]}{same}")
    sys.exit(0 if before in (None, again) else 1)


@click.command(short_help="Speed, pause, faults, supply, end of a served network.")
@click.argument("command", nargs=-1, required=True)
@click.option("--at", default="127.0.0.1:7411", metavar="[HOST:]PORT", help="Where serve --control listens.")
@click.option("--token", help="The word serve has printed; for other machines.")
def control(command: tuple[str, ...], at: str, token: str | None) -> None:
    """Tell a served network: status, speed X, pause, resume, power BOARD on|off, stop, snapshot [NAME].

    Faults: fault list, fault start NAME [ARGUMENT=VALUE...], fault clear NUMBER (docs/reference/faults.md).
    With serve --clock steps: step 5ms.
    """
    from scenarios.doors.stepped import tell

    click.echo(tell(" ".join(command), at, token))
