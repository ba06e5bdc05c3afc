"""What the command line asks of `schmidt serve` and `schmidt host`. Light: the command line imports it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path


class OptionError(ValueError):
    """A door that cannot be meant."""


@dataclass(frozen=True, kw_only=True)
class DoorOptions:
    """asked: specs as written, by the door's name in `scenarios.doors.table`. token: for clients of other
    machines; None: made up. logs: folder of the host's logs. runs: of what a console records. stars: a CSV
    of the cameras' sky; None: a synthetic one. frames: folder of their FITS files; None: none are written."""

    asked: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    token: str | None = None
    logs: Path | None = None
    runs: Path = Path("out/console")
    stars: Path | None = None
    frames: Path | None = None


@dataclass(frozen=True, kw_only=True)
class ServeOptions(DoorOptions):
    """Options of `schmidt serve`.

    clock: `wall`, or `steps`: time goes on when clients step it. duration: seconds of wall time. record:
    folder for the session. muted: a board that sends nothing and the candump log that its frames come
    from, times from the start on. realtime: ask the system to run the ticks before all other programs;
    None: where it grants that, at the pace of the wall. snapshots: the folder for those that are asked
    for on the way. begun: one to go on from; scenario, seed, plant and network are what is in it.
    """

    scenario: Path | None = None
    speed: float = 1.0
    clock: str = "wall"
    seed: int | None = None
    plant: str | None = None
    duration: float | None = None
    network: str | None = None
    muted: tuple[str, Path] | None = None
    realtime: bool | None = None
    record: Path | None = None
    snapshots: Path | None = None
    begun: Path | None = None


@dataclass(frozen=True, kw_only=True)
class HostOptions(DoorOptions):
    """Options of `schmidt host`. usb: where the gateway is. serial: BOARD=PORT of RS232 lines."""

    usb: str
    serial: tuple[str, ...] = ()
    scenario: Path | None = None
    network: str | None = None
    duration: float | None = None
