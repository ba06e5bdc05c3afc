"""What all Alpaca devices have: connection, names, actions, state; and how members are found."""

import asyncio
import importlib.metadata
from collections.abc import Callable, Coroutine, Mapping
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path
from typing import Any

import yaml

from host.alpaca.requests import (
    ACTION_NOT_IMPLEMENTED,
    DRIVER,
    AlpacaError,
    Parameters,
    not_implemented,
    of_refusal,
    within,
)
from host.telescope import AsyncDesk, Job, Refused, Snapshot, Telescope

_HEARD_S, _LOOK_S = 3.0, 0.05
"""Wall time a connection waits for the boards at most; they send every 5 to 250 ms. ASSUMPTION."""
Get = Callable[[Any, Parameters], Any]
Put = Callable[[Any, Parameters], Coroutine[Any, Any, Any]]
Act = Callable[[Telescope], object]


@dataclass(frozen=True)
class Member:
    """A property or a method by its ASCOM name. always: answered without a connection, too."""

    name: str
    get: Get | None = None
    put: Put | None = None
    always: bool = False


class Device:
    """One device. kind: the word in the URL. actions: name to what it does."""

    kind: str
    interface_version: int
    description: str
    members: Mapping[str, Member]
    actions: Mapping[str, Act] = {}
    unique_id: str
    number = "0"

    def __init__(self, desk: AsyncDesk) -> None:
        self.desk = desk
        self.connected = False

    @property
    def name(self) -> str:
        """For people."""
        return f"Schmidt {self.kind}"

    @property
    def now(self) -> Snapshot:
        """The telescope at the last tick."""
        return self.desk.now

    async def do(self, act: Act) -> None:
        """Have a command carried out, or raise `AlpacaError`."""
        try:
            await self.desk.do(act)
        except Refused as refusal:
            raise of_refusal(refusal) from None

    async def run(self, act: Callable[[Telescope], Job[Any]]) -> None:
        """The same, until it has ended."""
        try:
            await self.desk.run(act)
        except Refused as refusal:
            raise of_refusal(refusal) from None

    def state(self) -> dict[str, object]:
        """DeviceState without its time stamp."""
        raise NotImplementedError

    async def act(self, given: Parameters) -> str:
        """Action: one of SupportedActions."""
        name = given.text("Action")
        given.text("Parameters")
        found = {known.lower(): act for known, act in self.actions.items()}.get(name.lower())
        if found is None:
            raise AlpacaError(
                ACTION_NOT_IMPLEMENTED, f"no action {name!r}; there are {', '.join(self.actions)}"
            )
        await self.do(found)
        return "ok"


async def _set_connected(device: Device, given: Parameters) -> None:
    await (_connect if given.truth("Connected") else _disconnect)(device, given)


async def _connect(device: Device, _: Parameters) -> None:
    """Give boards that have just been switched on the moment they need: clients read as soon as they are
    connected. Boards that stay silent do not hold up the connection; each reading says so."""
    for _look in range(round(_HEARD_S / _LOOK_S)):
        try:
            device.state()
            break
        except AlpacaError:
            await asyncio.sleep(_LOOK_S)
    device.connected = True


async def _disconnect(device: Device, _: Parameters) -> None:
    device.connected = False


def does(act: Callable[[Any, Parameters], object]) -> Put:
    """A method that needs nothing of the telescope."""

    async def put(device: Device, given: Parameters) -> None:
        act(device, given)

    return put


def _command(_device: Device, given: Parameters) -> None:
    given.text("Command")
    given.truth("Raw")
    not_implemented("sending raw commands")


def _device_state(device: Device, _: Parameters) -> list[dict[str, object]]:
    stamp = device.desk.telescope.observatory.clock.iso(device.now.t_s)
    return [{"Name": name, "Value": value} for name, value in (device.state() | {"TimeStamp": stamp}).items()]


COMMON = (
    Member("Connected", lambda device, _: device.connected, _set_connected, always=True),
    Member("Connecting", lambda _device, _: False, always=True),
    Member("Connect", put=_connect, always=True),
    Member("Disconnect", put=_disconnect, always=True),
    Member("Description", lambda device, _: device.description, always=True),
    Member("DriverInfo", lambda _device, _: "schmidt, the Schmidt telescope's host program", always=True),
    Member("DriverVersion", lambda _device, _: importlib.metadata.version("schmidt"), always=True),
    Member("InterfaceVersion", lambda device, _: device.interface_version, always=True),
    Member("Name", lambda device, _: device.name, always=True),
    Member("SupportedActions", lambda device, _: list(device.actions), always=True),
    Member("DeviceState", _device_state),
    Member("Action", put=lambda device, given: device.act(given)),
    *(Member(f"Command{what}", put=does(_command)) for what in ("Blind", "Bool", "String")),
)


CONSTANTS: dict[str, dict[str, Any]] = yaml.safe_load(
    Path(__file__).with_name("constants.yaml").read_text(encoding="utf-8")
)


def table(kind: str, *members: Member) -> dict[str, Member]:
    """Members of a kind of device by the word in the URL; what needs no code is in `constants.yaml`."""
    own = CONSTANTS[kind]
    constant = [Member(name, fixed(value)) for name, value in own.get("fixed", {}).items()]
    constant += [Member(name, of(attrgetter(path))) for name, path in own.get("reads", {}).items()]
    constant += [Member(name, stated(name)) for name in own.get("stated", ())]
    constant += [Member(name, missing(name)) for name in own.get("missing", ())]
    constant += [Member(name, put=missing_put(name)) for name in own.get("missing_methods", ())]
    constant += [Member(name, missing(name), missing_put(name)) for name in own.get("missing_both", ())]
    return {member.name.lower(): member for member in (*COMMON, *constant, *members)}


def fixed(value: object) -> Get:
    """A property that never changes."""
    return lambda _device, _: value


def of(read: Callable[[Any], object]) -> Get:
    """A property that is read from the device alone."""
    return lambda device, _: read(device)


def stated(name: str) -> Get:
    """A property that `DeviceState` tells, too."""
    return lambda device, _: device.state()[name]


def zero(name: str, read: Callable[[Parameters, str], float]) -> Member:
    """A property that is 0, and that can be set to nothing else."""
    return Member(name, fixed(0), does(lambda _, given: within(name, read(given, name), 0, 0)))


def missing(name: str) -> Get:
    """A property this telescope does not have."""
    return lambda _device, _: not_implemented(name)


def missing_put(name: str) -> Put:
    """A method, or a property that cannot be set."""

    async def refuse(_device: Device, _: Parameters) -> None:
        not_implemented(name)

    return refuse


def unknown() -> AlpacaError:
    """Nothing has been received yet."""
    return AlpacaError(DRIVER, "the boards have sent nothing yet")
