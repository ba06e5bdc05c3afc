"""Commands with real time, cables and clients: serve, control, replay, host."""

import sys
from collections.abc import Iterator
from pathlib import Path

import click

from scenarios.doors.options import DoorOptions, HostOptions, ServeOptions
from scenarios.doors.table import ON_HOST, ON_NETWORK, asked
from scenarios.options import PATH, doors, filled, muting, need


@click.command(short_help="Run the boards in real time and open doors to them.")
@doors(*ON_NETWORK, *ON_HOST)
@muting
@filled(ServeOptions)
def serve(options: ServeOptions) -> None:
    """Pace the network in real time and open its doors; its boards answer to anyone."""
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
@doors(*ON_HOST)
@filled(HostOptions)
def host(options: HostOptions) -> None:
    """The host program by itself, on the boards' cables; SCENARIO gives site, mount and date."""
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
