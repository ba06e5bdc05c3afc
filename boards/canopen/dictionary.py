"""The object dictionary of a board: identity, parameters, and the documented frames as mapped PDOs."""

from typing import Any, Final

from canopen.objectdictionary import ObjectDictionary, ODArray, ODRecord, ODVariable, datatypes

from boards.core import Board
from boards.core.declared import DeclaredBoard
from bus.protocol import COMMAND_BASE, MEASUREMENT_BASE, REPLY_BASE, SUMMARY_BASE

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
SYNC: Final = 0x080
"""No device type is zero: CANopen's own choice is free here."""
NO_REMOTE: Final = 1 << 30
"""Of a TPDO's COB-ID: no remote frames (CiA 301, table 67)."""
MAPPED: Final = 8
"""Objects that a PDO holds at most: eight of a byte."""
HISTORY: Final = 8
"""Errors that 0x1003 remembers. ASSUMPTION."""
MASTERS: Final = 4
"""Heartbeats that 0x1016 watches. ASSUMPTION."""
BITRATE: Final = 1_000_000


def type_of(board: Board) -> tuple[str, int]:
    """Name and product code of a board's type, the same for all instances and no other type's.

    ASSUMPTION: the upper half of the device type (1..6). For a declared board, whose numbers lie among
    others', the first device type of its kind (from 0x10 on).
    """
    if isinstance(board, DeclaredBoard):
        return board.KIND.name, min(board.KIND.nodes.values())
    return board.name.partition("_")[0], board.device_type >> 4


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
    information.allowed_baudrates = {BITRATE}
    information.granularity = 8  # bits
    information.LSS_supported = False
    u8, u16, u32 = datatypes.UNSIGNED8, datatypes.UNSIGNED16, datatypes.UNSIGNED32
    found.add_object(_variable("Device type", 0x1000, 0, u32, 0))  # no device profile
    found.add_object(_variable("Error register", 0x1001, 0, u8, 0, mappable=True))
    found.add_object(_array("Pre-defined error field", 0x1003, u32, HISTORY, "ro", count="rw"))
    found.add_object(_variable("COB-ID SYNC", 0x1005, 0, u32, SYNC, "rw"))
    named = f"schmidt {name}"
    found.add_object(
        _variable("Manufacturer device name", 0x1008, 0, datatypes.VISIBLE_STRING, named, "const")
    )
    found.add_object(_array("Store parameters", 0x1010, u32, 1, "rw", 1))  # on command (table 57)
    found.add_object(_array("Restore default parameters", 0x1011, u32, 1, "rw", 1))
    found.add_object(_variable("COB-ID EMCY", 0x1014, 0, u32, EMCY_BASE + node))
    found.add_object(_array("Consumer heartbeat time", 0x1016, u32, MASTERS, "rw"))
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
    documents = _record("Documented frames", FRAMES, datatypes.UNSIGNED64, frames)
    for sub in range(1, len(frames) + 1):
        documents[sub].pdo_mappable = True
    documents[1].access_type = "rww"
    found.add_object(documents)
    _pdo(found, "RPDO1 COMMAND", 0x1400, COMMAND_BASE + node, 1)
    for number, (name, base) in enumerate(SENT):
        _pdo(found, f"TPDO{number + 1} {name}", 0x1800 + number, NO_REMOTE | base + node, 2 + number)
    for row in board.parameters.rows():
        variable = _variable(
            row.name, PARAMETERS + row.number, 0, datatypes.INTEGER32, row.read(), "rw", mappable=True
        )
        variable.min, variable.max = row.low, row.high
        found.add_object(variable)
    return found


def _variable(
    name: str,
    index: int,
    sub: int,
    kind: int,
    value: int | str,
    access: str = "ro",
    *,
    mappable: bool = False,
) -> ODVariable:
    variable: Any = ODVariable(name, index, sub)  # its default has the type of its data
    variable.data_type, variable.default, variable.access_type = kind, value, access
    variable.pdo_mappable = mappable
    assert isinstance(variable, ODVariable)
    return variable


def _record(name: str, index: int, kind: int, members: tuple[tuple[str, int], ...]) -> ODRecord:
    record = ODRecord(name, index)
    count = len(members)
    record.add_member(_variable("Highest sub-index supported", index, 0, datatypes.UNSIGNED8, count))
    for sub, (member, value) in enumerate(members, 1):
        record.add_member(_variable(member, index, sub, kind, value))
    return record


def _array(
    name: str, index: int, kind: int, length: int, access: str, value: int = 0, *, count: str = "ro"
) -> ODArray:
    """count: access of sub-index 0; one that can be written counts from nothing."""
    array = ODArray(name, index)
    full = length if count == "ro" else 0
    array.add_member(_variable("Number of entries", index, 0, datatypes.UNSIGNED8, full, count))
    for sub in range(1, length + 1):
        array.add_member(_variable(f"{name} {sub}", index, sub, kind, value, access))
    return array


def _pdo(found: ObjectDictionary, name: str, index: int, identifier: int, sub: int) -> None:
    """Communication and mapping records of a PDO that, as it comes, carries one documented frame."""
    u8, u32 = datatypes.UNSIGNED8, datatypes.UNSIGNED32
    record = ODRecord(f"{name} communication", index)
    record.add_member(_variable("Highest sub-index supported", index, 0, u8, 2))
    record.add_member(_variable("COB-ID", index, 1, u32, identifier, "rw"))
    record.add_member(_variable("Transmission type", index, 2, u8, _EVENT_DRIVEN, "rw"))
    found.add_object(record)
    mapping = ODRecord(f"{name} mapping", index + 0x200)
    mapping.add_member(_variable("Number of mapped objects", index + 0x200, 0, u8, 1, "rw"))
    for entry in range(1, MAPPED + 1):
        value = FRAMES << 16 | sub << 8 | _BITS if entry == 1 else 0
        mapping.add_member(_variable(f"Object {entry}", index + 0x200, entry, u32, value, "rw"))
    found.add_object(mapping)
