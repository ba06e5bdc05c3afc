"""DBC messages of a declared board, moved to its device type, and its own opcodes: layout, names, bounds."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterable, Sequence
from copy import deepcopy
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from bus.protocol.database import database
from bus.protocol.names import COMMAND_BASE, MEASUREMENT_BASE, SUMMARY_BASE, SUMMARY_KIND, Device, Opcode
from bus.protocol.nodes.kind import Kind, KindError, kind_of

if TYPE_CHECKING:
    from cantools.database import Database


_COMMON = Path(__file__).with_name("common.dbc")
_BASES = (COMMAND_BASE, MEASUREMENT_BASE, SUMMARY_BASE)


@cache
def _file(path: Path) -> Any:
    """A DBC file; raises KindError with one line for one that cannot be read."""
    from cantools.database import load_file
    from cantools.database.errors import Error

    if Path(path).exists() and not Path(path).is_file():  # a pipe or a device may never end
        raise KindError(f"{path}: it is no regular file")
    try:
        return load_file(path, strict=True)
    except OSError as error:
        raise KindError(f"{path}: {(error.strerror or 'cannot be read').lower()}") from None
    except (Error, ValueError) as error:
        raise KindError(f"{path}: no DBC: {str(error).splitlines()[0]}") from None


def own_messages(kind: Kind) -> list[Any]:
    """The frames that a kind sends of itself, as its DBC has them, for device type 0: shortest period first.

    Raises KindError for a file without any, and for frames the protocol has no place for.
    """
    found = _file(kind.dbc).messages
    for message in found:
        if message.frame_id not in _BASES or message.length != 8:
            raise KindError(
                f"{kind.dbc}: {message.name} is {message.length} bytes at {message.frame_id};"
                f" a declared board's frames have 8, at {' or '.join(map(str, _BASES))}"
            )
        if "_" in message.name:
            raise KindError(f"{kind.dbc}: frame {message.name}: a frame's name has no underscore")
    sent = [message for message in found if message.frame_id != COMMAND_BASE]
    if not sent or any(not message.cycle_time for message in sent):
        raise KindError(f"{kind.dbc}: needs a frame at {MEASUREMENT_BASE}, and GenMsgCycleTime for each")
    return sorted(sent, key=lambda message: (message.cycle_time, message.frame_id))


def command_of(kind: Kind) -> Any | None:
    """COMMAND as the kind's own DBC has it, or None."""
    return next((each for each in _file(kind.dbc).messages if each.frame_id == COMMAND_BASE), None)


@cache
def messages_of(kind: Kind) -> list[Any]:
    """All frames of all boards of a kind, as cantools messages."""
    common = {message.frame_id: message for message in _file(_COMMON).messages}
    own = {message.frame_id: message for message in own_messages(kind)}
    own_command = command_of(kind)
    return [
        _moved(kind, name, number, message, own_command)
        for name, number in kind.nodes.items()
        for _, message in sorted((common | own).items())
    ]


def _moved(kind: Kind, name: str, number: int, message: Any, own_command: Any | None) -> Any:
    from cantools.database.can import Message
    from cantools.database.errors import Error

    base = message.frame_id
    signals = deepcopy(message.signals)
    opcodes = opcode_names(own_command)
    if base == COMMAND_BASE and own_command is not None:
        signals += [deepcopy(signal) for signal in own_command.signals if signal.multiplexer_ids]
    for signal in signals:
        signal.receivers = [name if each == "NODE" else each for each in signal.receivers]
        if signal.name == "Opcode" and base in (COMMAND_BASE, 0x100):
            _choices(signal, {1: "PING", 2: "GET_PARAMETER", 3: "SET_PARAMETER"} | opcodes)
        elif signal.name.endswith("Parameter_Number"):
            _choices(signal, {row.number: row.name.upper() for row in kind.parameters})
    try:
        return Message(
            base + number,
            f"{name}_{message.name}",
            8,
            [_device(name, number), *(_kind_byte() if base == SUMMARY_BASE else ()), *signals],
            comment=message.comment,
            senders=["GATEWAY" if base == COMMAND_BASE else name],
            cycle_time=message.cycle_time,
            strict=True,
        )
    except Error as error:
        raise KindError(f"{kind.dbc}: {error}") from None


def opcode_names(command: Any | None) -> dict[int, str]:
    """Opcodes that a COMMAND names, by number."""
    if command is None:
        return {}
    return {int(k): str(v) for k, v in (command.get_signal_by_name("Opcode").choices or {}).items()}


def _choices(signal: Any, names: dict[int, str]) -> None:
    from cantools.database.conversion import BaseConversion

    signal.conversion = BaseConversion.factory(choices=OrderedDict(names) if names else None)


def _device(name: str, number: int) -> Any:
    from cantools.database.can import Signal
    from cantools.database.conversion import BaseConversion

    own = BaseConversion.factory(choices=OrderedDict({number: name}))
    return Signal(
        "Device", 0, 8, raw_initial=number, conversion=own,
        minimum=number, maximum=number, comment="Device type.",
    )  # fmt: skip


def _kind_byte() -> Sequence[Any]:
    from cantools.database.can import Signal

    return (Signal("Kind", 8, 8, raw_initial=SUMMARY_KIND, minimum=SUMMARY_KIND, maximum=SUMMARY_KIND),)


def documented(devices: Iterable[Device]) -> Database:
    """schmidt.dbc and the frames of those kinds that some of `devices` belong to."""
    from cantools.database import Database
    from cantools.database.can import Node

    kinds = dict.fromkeys(kind for device in devices if (kind := kind_of(device)) is not None)
    if not kinds:
        return database()
    base = database()
    own = [message for kind in kinds for message in messages_of(kind)]
    nodes = [Node(name) for kind in kinds for name in kind.nodes]
    return Database([*base.messages, *own], [*base.nodes, *nodes], dbc_specifics=base.dbc)


_CODES = {
    (8, False): "B",
    (8, True): "b",
    (16, False): "H",
    (16, True): "h",
    (32, False): "I",
    (32, True): "i",
}
_FIRST, _LAST = 16, 64
"""Arguments lie in bytes 2..7."""


class Argument(NamedTuple):
    """name in lower case; low, high: bounds as they stand on the wire."""

    name: str
    low: int
    high: int


@cache
def arguments_of(kind: Kind) -> dict[Opcode, tuple[Argument, ...]]:
    """Opcodes of the kind's own, as `pack_command` takes them, and their arguments.

    Raises KindError for arguments that are not whole bytes and for an opcode no declared board can have.
    """
    command = command_of(kind)
    found: dict[Opcode, tuple[Argument, ...]] = {}
    own = [] if command is None else command.signals
    for number, name in sorted(opcode_names(command).items()):
        if number < 0x40 or number >= 0x7E:
            raise KindError(f"{kind.dbc}: opcode {number:#04x}: a declared board's own are 0x40..0x7d")
        signals = sorted(
            (each for each in own if each.multiplexer_ids == [number] and "Spare" not in each.name),
            key=lambda signal: signal.start,
        )
        layout, at, arguments = "<", _FIRST, []
        for signal in signals:
            code = _CODES.get((signal.length, signal.is_signed))
            if code is None or signal.start < at or signal.start % 8 or signal.start + signal.length > _LAST:
                raise KindError(
                    f"{kind.dbc}: {signal.name}: an argument is 1, 2 or 4 bytes within bytes 2..7"
                )
            layout += f"{(signal.start - at) // 8}x{code}"
            at = signal.start + signal.length
            low, high = (
                round((each - signal.offset) / signal.scale) for each in (signal.minimum, signal.maximum)
            )
            arguments.append(Argument(signal.name.rpartition("_")[2].lower(), low, high))
        declared = f"{layout}{(_LAST - at) // 8}x", tuple(each.name for each in arguments)
        found[Opcode.further(name, number, declared)] = tuple(arguments)
    return found
