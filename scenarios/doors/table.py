"""The doors there are, one row each.

A new door is a file beside this one, with a class that is a `Door`, and a row here. Then `schmidt serve` has
its option, and `schmidt host`, too, when it stands on the host program. Doors are imported when one is asked
for, as the command line needs the rows alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

from scenarios.doors.options import DoorOptions
from scenarios.native.modules import PACKAGE

if TYPE_CHECKING:
    from scenarios.doors.door import Door
    from scenarios.doors.livenetwork import LiveNetwork
    from scenarios.doors.pc import Host

Place = TypeVar("Place")
"""What a door stands on: the network in this process, or the host program wherever it runs."""


class Asked(NamedTuple):
    """One door as it was asked for. spec: what follows its option; number: of its kind, from 0. token: for
    clients of other machines; None: made up."""

    spec: str
    number: int
    token: str | None


@dataclass(frozen=True, kw_only=True)
class DoorKind(Generic[Place]):
    """A row: the option `--name` with its value's form, what `-h` says of it, what makes the door.

    attach: what `schmidt serve` prints, by the word before the value's colon ("": any other). {at}: it is on
    TCP, here; with {last}: a port for each RS232 line, from that of {first} on; {lines}: a file for each.
    extra: of pyproject.toml, with the packages it imports beyond those of every installation.
    """

    name: str
    form: str
    help: str
    make: Callable[[Asked, Place], Door]
    attach: Mapping[str, str] = field(default_factory=lambda: {"": "{spec}"})
    repeatable: bool = True
    extra: str | None = None


def _class(name: str) -> Any:
    """A door's class by its full name; its module is imported now."""
    module, _, word = name.rpartition(".")
    return getattr(import_module(PACKAGE + module), word)


def _serial(asked: Asked, live: LiveNetwork) -> Any:
    kinds = {"pty": "scenarios.doors.serial_pty.PtyDoor", "tcp": "scenarios.doors.serial_tcp.TcpDoor"}
    kind, _, rest = asked.spec.partition(":")
    if kind not in kinds or not rest:
        raise ValueError(f'--serial "{asked.spec}": expected pty:DIR or tcp:[HOST:]PORT')
    return _class(kinds[kind])(rest, live)


def _hid(asked: Asked, live: LiveNetwork) -> Any:
    if asked.spec == "uhid":
        return _class("scenarios.doors.hid_uhid.UhidDoor")(live)
    kind, _, path = asked.spec.partition(":")
    if kind != "unix" or not path:
        raise ValueError(f'--hid "{asked.spec}": expected uhid or unix:PATH')
    return _class("scenarios.doors.hid_unix.UnixDoor")(path, live)


ON_NETWORK: tuple[DoorKind[LiveNetwork], ...] = (
    DoorKind(
        name="can", form="INTERFACE:CHANNEL",
        make=lambda asked, live: _class("scenarios.doors.can.CanDoor")(asked.spec, asked.number, live),
        help="The CAN bus, such as socketcan:vcan0; repeatable.",
        attach={"": "python-can: interface={word}, channel={rest}"},
    ),
    DoorKind(
        name="serial", form="pty:DIR|tcp:PORT", make=_serial,
        help="The RS232 lines: pseudo-terminals in DIR, or TCP ports from PORT on (five; final: twelve).",
        attach={"pty": "{lines}", "tcp": "socket://{at} is {first}, and so on to {last}"},
    ),
    DoorKind(
        name="hid", form="uhid|unix:PATH", make=_hid, help="The gateway's USB: /dev/hidrawN, or a socket.",
    ),
    DoorKind(
        name="debug", form="DIR", attach={"": "slcan in {spec}"}, repeatable=False,
        make=lambda asked, live: _class("scenarios.doors.serial_pty.DebugDoor")(asked.spec, live),
        help="Every board's debug port as a pseudo-terminal in DIR (slcan).",
    ),
    DoorKind(
        name="control", form="[HOST:]PORT", repeatable=False,
        make=lambda asked, live: _class("scenarios.doors.control.ControlDoor")(asked.spec, asked.token, live),
        help="Speed, pause, status, stop (see schmidt control).",
        attach={"": "schmidt control status --at {at}"},
    ),
)  # fmt: skip
"""In the order in which their nodes come onto the wire."""
ON_HOST: tuple[DoorKind[Host], ...] = (
    DoorKind(
        name="lx200", form="[HOST:]PORT|pty:NAME",
        make=lambda asked, host: _class("scenarios.doors.lx200.Lx200Door")(asked.spec, host),
        help="LX200, for Stellarium and INDI; repeatable.",
        attach={"pty": "{spec}", "": "LX200 over TCP, {at}"},
    ),
    DoorKind(
        name="alpaca", form="[HOST:]PORT", extra="alpaca", repeatable=False,
        make=lambda asked, host: _class("scenarios.doors.alpaca.AlpacaDoor")(asked.spec, host),
        help="ASCOM Alpaca telescope and focuser, of an emulated sky (serve) cameras, too; with discovery.",
        attach={"": "ASCOM Alpaca at http://{at}/"},
    ),
    DoorKind(
        name="console", form="[HOST:]PORT", extra="consoles", repeatable=False,
        make=lambda asked, host: _class("scenarios.doors.console.ConsoleDoor")(asked.spec, asked.token, host),
        help="The consoles, for a browser.", attach={"": "open http://{at}/"},
    ),
)  # fmt: skip


def asked(kinds: Sequence[DoorKind[Place]], options: DoorOptions) -> list[tuple[DoorKind[Place], Asked]]:
    """What the options ask for of these kinds, in the table's order."""
    return [
        (kind, Asked(spec, number, options.token))
        for kind in kinds
        for number, spec in enumerate(options.asked.get(kind.name, ()))
    ]


def doors_on(kinds: Sequence[DoorKind[Place]], options: DoorOptions, place: Place) -> list[Door]:
    """Those that the options ask for, closed. Raises ValueError subclasses for what cannot be meant."""
    return [kind.make(each, place) for kind, each in asked(kinds, options)]


def named(kinds: Iterable[DoorKind[Any]], joined: str) -> str:
    """Their options in a sentence: `--lx200, --alpaca and --console`."""
    *most, last = [f"--{kind.name}" for kind in kinds]
    return f"{', '.join(most)} {joined} {last}"
