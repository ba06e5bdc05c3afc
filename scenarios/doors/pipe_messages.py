"""What `schmidt serve` and the host program beside it tell each other, over a pipe.

The host has a process of its own, as it has on the telescope. Browsers and HTTP would otherwise hold Python's
lock when a tick is due. Nothing but these values crosses; the emulator's side is `host_door`, the host's
`piped_host`. Beside the records below there are tuples of a word and what belongs to it.

From the host come `report` (64 bytes for the gateway), `said` (a line for the user) and `opened` (doors,
error). A `wish` has a number and a command of the control plane. To the host go `done` (the wish's number,
its answer, whether it was refused) and `close`: hang up, write the logs, answer `Taken` and end.
"""

from pathlib import Path
from typing import NamedTuple

from bus.protocol import Device
from host.camera.models import Look
from host.console.views import BusState, FaultKind
from scenarios.doors.options import ServeOptions
from scenarios.language.model import Scenario


class Settings(NamedTuple):
    """The first message: all that a host is told. boards: names of all; devices: those it expects; headers:
    of the axis logs; `scenario` has a date."""

    scenario: Scenario
    options: ServeOptions
    boards: list[str]
    devices: tuple[Device, ...]
    headers: dict[str, dict[str, str]]
    kinds: list[FaultKind]


class Slice(NamedTuple):
    """To the host: simulated time has come this far, and this has come over the cables since. lines: (board,
    bytes) of RS232 lines that are recorded. bus: None when nobody looks at it. looks: where the telescope
    truly looked, for a camera whose shutter is open."""

    now_ns: int
    reports: list[tuple[int, bytes]]
    lines: list[tuple[str, bytes]]
    bus: BusState | None
    looks: list[Look]


class Taken(NamedTuple):
    """From the host: that slice is done with. Until then no other is sent. watching: somebody looks at the
    bus; recording: somebody wants the lines; looking: a shutter is open; doors: (name, state) of each."""

    watching: bool
    recording: bool
    looking: bool
    doors: list[tuple[str, str]]


def program() -> str:
    """The host's side as Python is told to run it; the pipe's number is its argument."""
    return f"import sys; sys.path.insert(0, {str(Path(__file__).parents[2])!r});" + (
        " from scenarios.doors.piped_host import main; main(int(sys.argv[1]))"
    )
