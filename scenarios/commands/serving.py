"""Commands with real time, cables and clients: serve, control, replay, host."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from scenarios.commands.options import NETWORK, SECONDS, SEED, SPEED, feeding, host_doors


@click.command(short_help="Run the boards in real time and open doors to them.")
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
@host_doors
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
@click.option("--realtime", is_flag=True, help="Ask the system to run the ticks before all other programs.")
@click.option("--record", type=click.Path(path_type=Path), help="Record the session in this folder.")
@click.option(
    "--snapshots",
    type=click.Path(path_type=Path),
    metavar="DIR",
    help="Take snapshots into DIR when schmidt control asks for them; runs plain.",
)
@click.option(
    "--from", "begun", type=click.Path(path_type=Path), help="Go on from this snapshot; takes no SCENARIO."
)
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
    realtime: bool,
    record: Path | None,
    snapshots: Path | None,
    begun: Path | None,
) -> None:
    """Pace the network in real time and open its doors; its boards answer to anyone."""
    if snapshots is not None or begun is not None:
        from scenarios.native.finder import plain

        plain()  # as in run
    if begun is not None and (scenario or seed is not None or plant or network or mute):
        raise click.UsageError("--from goes on with what is in the snapshot, nothing else")
    from scenarios.doors.options import DoorOptions
    from scenarios.serve import serve as command

    options = DoorOptions(can, serial, hid, control, token, lx200, alpaca, logs, console, runs, debug)
    muted = feeding(mute, feed)
    kept: dict[str, Any] = {"realtime": realtime, "snapshots": snapshots, "begun": begun}
    sys.exit(command(scenario, options, speed, seed, plant, duration, record, network, muted, **kept))


@click.command(short_help="The host program alone, on the boards' cables.")
@click.argument("scenario", type=click.Path(path_type=Path), required=False)
@click.option("--usb", required=True, metavar="/dev/hidrawN|unix:PATH|can:SPEC", help="Where the gateway is.")
@click.option(
    "--serial", multiple=True, metavar="BOARD=PORT", help="RS232 of a board, such as AXIS_RA=/dev/ttyS0."
)
@host_doors
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


@click.command(short_help="Repeat a session that serve --record has left.")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), help="Output folder (default: FOLDER-replayed).")
@click.option(
    "--from", "begun", type=click.Path(path_type=Path), help="Only what came after this snapshot of it."
)
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
    fault list, fault start NAME [ARGUMENT=VALUE...], fault clear NUMBER (docs/faults.md),
    snapshot [NAME] (docs/scenarios.md).
    """
    from scenarios.doors.tell import tell

    click.echo(tell(" ".join(command), at, token))
