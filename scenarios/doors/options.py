"""Which doors the command line asks for, and the objects that stand for them.

A new door: a field here, an option of `serve` in `scenarios/commands/serving.py`, a line in `make_doors`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from scenarios.doors.door import Door
from scenarios.doors.served import Served

if TYPE_CHECKING:
    from scenarios.doors.host import Host


class OptionError(ValueError):
    """A door that cannot be meant."""


@dataclass(frozen=True)
class DoorOptions:
    """As written after `--can`, `--serial`, `--hid`, `--control`, `--lx200`, `--alpaca` (None: not asked
    for); logs: folder of the host's logs."""

    can: tuple[str, ...] = ()
    serial: tuple[str, ...] = ()
    hid: tuple[str, ...] = ()
    control: str | None = None
    token: str | None = None
    lx200: tuple[str, ...] = ()
    alpaca: str | None = None
    logs: Path | None = None
    console: str | None = None
    runs: Path = Path("out/console")
    debug: str | None = None

    def check(self) -> None:
        """Raise OptionError unless there is a door at all."""
        if all(
            value == default for value, default in zip(_values(self), _values(DoorOptions()), strict=True)
        ):
            raise OptionError(
                "serve needs a door: --can, --serial, --hid, --lx200, --alpaca, --console, --debug "
                "or --control (see schmidt serve -h)"
            )


def _values(options: DoorOptions) -> list[object]:
    return list(vars(replace(options, token=None, logs=None, runs=DoorOptions.runs)).values())


def make_doors(options: DoorOptions, served: Served, say: Callable[[str], None] = print) -> list[Door]:
    """The doors, closed. Their nodes on the wire are there from now on, in this order. say: takes lines for
    the user."""
    from scenarios.doors.can import CanDoor

    doors: list[Door] = [CanDoor(spec, index, served) for index, spec in enumerate(options.can)]
    doors += [_serial(spec, served) for spec in options.serial]
    doors += [_hid(spec, served) for spec in options.hid]
    if options.debug is not None:
        from scenarios.doors.debug_pty import DebugDoor

        doors.append(DebugDoor(options.debug, served))
    if options.control is not None:
        from scenarios.doors.control import ControlDoor

        doors.append(ControlDoor(options.control, options.token, served))
    if options.lx200 or options.alpaca is not None or options.console is not None:
        if "GATEWAY" not in served.network.boards:
            raise OptionError("--lx200, --alpaca and --console need the gateway: take --network lab or final")
        doors += _astronomy(options, served, say)
    return doors


def _astronomy(options: DoorOptions, served: Served, say: Callable[[str], None]) -> list[Door]:
    """The host first, in a process of its own: what follows lives on it."""
    from scenarios.doors.address import address
    from scenarios.doors.hostprocess import HostedDoor, HostProcess

    wanted = [("--lx200", spec) for spec in options.lx200]
    wanted += [("--alpaca", options.alpaca)] if options.alpaca is not None else []
    wanted += [("--console", options.console)] if options.console is not None else []
    for option, spec in wanted:
        if not spec.startswith("pty:"):
            address(spec, option)  # said before anything is started
    host = HostProcess(served, options, say)
    return [host, *(HostedDoor(host, k + 1, " ".join(each)) for k, each in enumerate(wanted))]


def astronomy(options: DoorOptions, host: Host) -> list[Door]:
    """Doors for astronomers' programs, on a host."""
    from host.lx200.server import Lx200
    from scenarios.doors.alpaca import AlpacaDoor
    from scenarios.doors.lx200 import Lx200Door

    lx200 = Lx200(host.hosted.telescope)
    doors: list[Door] = [Lx200Door(spec, host, lx200) for spec in options.lx200]
    if options.alpaca is not None:
        doors.append(AlpacaDoor(options.alpaca, host))
    return doors


def _serial(spec: str, served: Served) -> Door:
    from scenarios.doors.serial_pty import PtyDoor
    from scenarios.doors.serial_tcp import Rfc2217Door, TcpDoor

    kinds: dict[str, Callable[[str, Served], Door]] = {"pty": PtyDoor, "tcp": TcpDoor, "rfc2217": Rfc2217Door}
    return _pick("--serial", spec, kinds, "pty:DIR, tcp:[HOST:]PORT or rfc2217:[HOST:]PORT", served)


def _hid(spec: str, served: Served) -> Door:
    from scenarios.doors.hid_uhid import UhidDoor
    from scenarios.doors.hid_unix import UnixDoor

    if spec == "uhid":
        return UhidDoor(served)
    return _pick("--hid", spec, {"unix": UnixDoor}, "uhid or unix:PATH", served)


def _pick(
    option: str, spec: str, kinds: dict[str, Callable[[str, Served], Door]], expected: str, served: Served
) -> Door:
    kind, _, rest = spec.partition(":")
    if kind not in kinds or not rest:
        raise OptionError(f'{option} "{spec}": expected {expected}')
    return kinds[kind](rest, served)
