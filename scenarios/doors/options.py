"""What the command line asks of `schmidt serve` and `schmidt host`. Light: the command line imports it."""

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field
from pathlib import Path

import click

from scenarios.options import NETWORK, PATH, SECONDS, SEED, SPEED, WORD, argument, option


@dataclass(frozen=True, kw_only=True)
class DoorOptions:
    """asked: specs as written, by the door's name in `scenarios.doors.table`. token: for clients of other
    machines; None: made up."""

    scenario: Path | None = argument(type=PATH)
    asked: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    runs: Path = option("Folder of the runs recorded on the console.", type=PATH, default=Path("out/console"))
    logs: Path | None = option("Folder of the host's four logs and of its guide log.", type=PATH)
    token: str | None = option("Word that other machines must know (default: made up, printed).", **WORD)
    network: str | None = option(**NETWORK)
    duration: float | None = option("End after this many seconds.", type=SECONDS)


@dataclass(frozen=True, kw_only=True)
class ServeOptions(DoorOptions):
    """Options of `schmidt serve`. duration: of wall time.

    muted: a board that sends nothing and the candump log that its frames come from, times from the start on.
    begun: a snapshot to go on from; scenario, seed, plant and network are what is in it.
    """

    stars: Path | None = option("The cameras' stars: a CSV with name, ra, dec, magnitude.", type=PATH)
    frames: Path | None = option("Folder for the cameras' frames as FITS files.", type=PATH, metavar="DIR")
    speed: float = option("Times real time.", type=SPEED, default=1.0)
    clock: str = option(
        "steps: time stands until clients of --control step it.",
        type=click.Choice(["wall", "steps"]),
        default="wall",
    )
    seed: int | None = option("Another seed than the scenario's.", type=SEED)
    plant: str | None = option("Plant file, or the name of one that comes with schmidt.")
    muted: tuple[str, Path] | None = None
    realtime: bool | None = option(
        "Run the ticks before all other programs (default: up to speed 1, where the system grants it).",
        "--realtime/--no-realtime",
    )
    record: Path | None = option("Record the session in this folder.", type=PATH)
    snapshots: Path | None = option(
        "Take snapshots into DIR when schmidt control asks for them; runs plain.", type=PATH, metavar="DIR"
    )
    begun: Path | None = option("Go on from this snapshot; takes no SCENARIO.", "--from", type=PATH)


@dataclass(frozen=True, kw_only=True)
class HostOptions(DoorOptions):
    """Options of `schmidt host`."""

    usb: str = option("Where the gateway is.", metavar="/dev/hidrawN|unix:PATH|can:SPEC", default=MISSING)
    serial: tuple[str, ...] = option(
        "RS232 of a board, such as AXIS_RA=/dev/ttyS0.", metavar="BOARD=PORT", multiple=True, default=()
    )
