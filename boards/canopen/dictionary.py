"""The object dictionary of a board: identity, parameters, and the documented frames as mapped PDOs."""

from __future__ import annotations

from typing import Final

from canopen.objectdictionary import ObjectDictionary, ODRecord, ODVariable, datatypes

from boards.core import Board
from bus.protocol import COMMAND_BASE, MEASUREMENT_BASE, REPLY_BASE, SUMMARY_BASE
from bus.protocol.nodes import kind_of

EMCY_BASE: Final = 0x180
"""CANopen's own choice, 0x080 + node, is where commands are; 0x1014 says where it is (CiA 301, 7.5.2.17)."""
STATUS_BASE: Final = 0x380
"""The documented HEARTBEAT; 0x700 + node is CANopen's heartbeat here."""
PARAMETERS: Final = 0x2100
"""Parameter k is 0x2100 + k, the manufacturer's range (CiA 301, table 19)."""
FRAMES: Final = 0x2000
"""The frames, eight bytes each: sub-index 1 COMMAND, then what the board sends."""
HEARTBEAT_MS: Final = 1000
"""As often as the documented one."""
SENT: Final = (
    ("REPLY", REPLY_BASE),
    ("MEASUREMENT", MEASUREMENT_BASE),
    ("SUMMARY", SUMMARY_BASE),
    ("HEARTBEAT", STATUS_BASE),
)
_EVENT_DRIVEN = 0xFF
"""Transmission type: as the device profile says, here: as documented (CiA 301, table 72)."""
_BITS = 64


def type_of(board: Board) -> tuple[str, int]:
    """Name and product code of a board's type, the same for all instances and no other type's.

    ASSUMPTION: the upper half of the device type (1..6); for a declared board, whose numbers lie among
    others', the first device type of its kind (from 0x10 on).
    """
    kind = kind_of(board.device_type)
    if kind is None:
        return board.name.partition("_")[0], board.device_type >> 4
    return kind.name, min(kind.nodes.values())


def dictionary(board: Board) -> ObjectDictionary:
    """The dictionary of `board`, whose node number is its device type."""
    found = ObjectDictionary()
    node = board.device_type
    found.node_id = node
    information = found.device_information
    information.vendor_name = "schmidt"
    information.vendor_number = 0
    name, product = type_of(board)
    information.product_name = name
    information.product_number = product
    for word, count in (("nr_of_TXPDO", len(SENT)), ("nr_of_RXPDO", 1)):  # numbers, though typed as bool
        setattr(information, word, count)
    information.simple_boot_up_slave = True
    u8, u16, u32 = datatypes.UNSIGNED8, datatypes.UNSIGNED16, datatypes.UNSIGNED32
    found.add_object(_variable("Device type", 0x1000, 0, u32, 0))  # no device profile
    found.add_object(_variable("Error register", 0x1001, 0, u8, 0))
    found.add_object(_variable("COB-ID EMCY", 0x1014, 0, u32, EMCY_BASE + node))
    found.add_object(_variable("Producer heartbeat time", 0x1017, 0, u16, HEARTBEAT_MS, "rw"))
    # Vendor 0: none is registered with CiA. ASSUMPTION: serial number by device type.
    identity = (
        ("Vendor-ID", 0),
        ("Product code", product),
        ("Revision number", 1),
        ("Serial number", node),
    )
    found.add_object(_record("Identity object", 0x1018, u32, identity))
    server = (("COB-ID client to server", 0x600 + node), ("COB-ID server to client", 0x580 + node))
    found.add_object(_record("SDO server parameter", 0x1200, u32, server))
    frames = (("COMMAND", 0), *((name, 0) for name, _ in SENT))
    found.add_object(_record("Documented frames", FRAMES, datatypes.UNSIGNED64, frames, "rw"))
    _pdo(found, "RPDO1 COMMAND", 0x1400, COMMAND_BASE + node, 1)
    for number, (name, base) in enumerate(SENT):
        _pdo(found, f"TPDO{number + 1} {name}", 0x1800 + number, base + node, 2 + number)
    for row in board.parameters.rows():
        variable = _variable(row.name, PARAMETERS + row.number, 0, datatypes.INTEGER32, row.read(), "rw")
        variable.min, variable.max = row.low, row.high
        found.add_object(variable)
    return found


def _variable(name: str, index: int, sub: int, kind: int, value: int, access: str = "ro") -> ODVariable:
    variable = ODVariable(name, index, sub)
    variable.data_type, variable.default, variable.access_type = kind, value, access
    return variable


def _record(
    name: str, index: int, kind: int, members: tuple[tuple[str, int], ...], access: str = "ro"
) -> ODRecord:
    record = ODRecord(name, index)
    count = len(members)
    record.add_member(_variable("Highest sub-index supported", index, 0, datatypes.UNSIGNED8, count))
    for sub, (member, value) in enumerate(members, 1):
        record.add_member(_variable(member, index, sub, kind, value, access))
    return record


def _pdo(found: ObjectDictionary, name: str, index: int, identifier: int, sub: int) -> None:
    """Communication and mapping records of a PDO that carries one documented frame."""
    record = ODRecord(f"{name} communication", index)
    record.add_member(_variable("Highest sub-index supported", index, 0, datatypes.UNSIGNED8, 2))
    record.add_member(_variable("COB-ID", index, 1, datatypes.UNSIGNED32, identifier))
    record.add_member(_variable("Transmission type", index, 2, datatypes.UNSIGNED8, _EVENT_DRIVEN))
    found.add_object(record)
    mapped = (("Frame", FRAMES << 16 | sub << 8 | _BITS),)
    found.add_object(_record(f"{name} mapping", index + 0x200, datatypes.UNSIGNED32, mapped))
