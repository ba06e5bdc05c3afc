"""`canopen.dbc`: what is on a bus whose boards speak CANopen, for programs that decode frames."""

from collections.abc import Iterable
from typing import Any, Final

from boards.canopen.dictionary import EMCY_BASE, STATUS_BASE, SYNC
from bus.protocol import HEARTBEAT_BASE, Device
from bus.protocol.nodes import documented

_STATES: Final = {0: "BOOT_UP", 4: "STOPPED", 5: "OPERATIONAL", 127: "PRE_OPERATIONAL"}
_ORDERS: Final = {
    1: "START",
    2: "STOP",
    128: "PRE_OPERATIONAL",
    129: "RESET_NODE",
    130: "RESET_COMMUNICATION",
}
_SDO: Final = (("Command", 8), ("Index", 16), ("Subindex", 8), ("Data", 32))
_OF_A_NODE: Final = (
    ("EMCY", EMCY_BASE, (("Code", 16), ("Register", 8), ("Health", 16)), 8),
    ("SDO_ANSWER", 0x580, _SDO, 8),
    ("SDO_REQUEST", 0x600, _SDO, 8),
    ("NMT_STATE", HEARTBEAT_BASE, (("State", 8),), 1),
)
"""Name, identifier less node number, signals with their bits in order, bytes (CiA 301, 7.2)."""


def canopen_dbc(devices: Iterable[Device]) -> str:
    """The documented frames of `devices`, HEARTBEAT where it is now, and CANopen's own; as a DBC file."""
    from cantools import database

    documents = database.load_string(documented(devices).as_dbc_string(), "dbc")
    assert isinstance(documents, database.can.Database)
    for message in documents.messages:
        if message.frame_id & ~0x7F == HEARTBEAT_BASE:
            message.frame_id += STATUS_BASE - HEARTBEAT_BASE
    frames = [
        _message("NMT", 0x000, (("Order", 8), ("Node", 8)), 2, {"Order": _ORDERS}),
        _message("SYNC", SYNC, (), 0, {}),
    ]
    for device in devices:
        for name, base, signals, length in _OF_A_NODE:
            frames.append(
                _message(f"{device.name}_{name}", base + device, signals, length, {"State": _STATES})
            )
    documents.messages.extend(frames)
    documents.refresh()
    return documents.as_dbc_string(sort_signals=None).replace("\r\n", "\n")


def _message(
    name: str, identifier: int, signals: tuple[tuple[str, int], ...], length: int, choices: dict[str, Any]
) -> Any:
    from cantools.database.can import Message, Signal
    from cantools.database.conversion import BaseConversion

    found, at = [], 0
    for signal, bits in signals:
        named = BaseConversion.factory(choices=choices.get(signal))
        found.append(Signal(signal, at, bits, conversion=named, minimum=0, maximum=(1 << bits) - 1))
        at += bits
    return Message(identifier, name, length, found, strict=True)
