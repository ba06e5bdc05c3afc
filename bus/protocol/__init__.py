"""The protocol. `schmidt.dbc` is the source; the codecs beside it are held to it by tests."""

from bus.protocol.command_layouts import CommandError, layout_of, opcodes, pack_command, unpack_command
from bus.protocol.heartbeat import (
    Heartbeat,
    Reply,
    pack_heartbeat,
    pack_reply,
    unpack_heartbeat,
    unpack_reply,
)
from bus.protocol.motion import (
    Focus,
    FocusFlag,
    Motion,
    MotionFlag,
    Tach,
    pack_focus,
    pack_motion,
    pack_tach,
    unpack_focus,
    unpack_motion,
    unpack_tach,
)
from bus.protocol.names import (
    COMMAND_BASE,
    FRAME_BYTES,
    HARMONICS,
    HEARTBEAT_BASE,
    HEARTBEAT_KIND,
    MEASUREMENT_BASE,
    OBSERVER_CELLS,
    REPLY_BASE,
    SUMMARY_BASE,
    SUMMARY_KIND,
    AxisMode,
    AxisParameter,
    Device,
    Health,
    Opcode,
    Result,
    SpeedClass,
    State,
)
from bus.protocol.position import (
    AGE_UNIT_NS,
    Position,
    PositionFlag,
    Summary,
    Target,
    pack_position,
    pack_summary,
    pack_target,
    unpack_position,
    unpack_summary,
    unpack_target,
)

__all__ = [
    "AGE_UNIT_NS", "COMMAND_BASE", "FRAME_BYTES", "HARMONICS", "HEARTBEAT_BASE", "HEARTBEAT_KIND",
    "MEASUREMENT_BASE", "OBSERVER_CELLS", "REPLY_BASE", "SUMMARY_BASE", "SUMMARY_KIND", "AxisMode",
    "AxisParameter", "CommandError", "Device", "Focus", "FocusFlag", "Health", "Heartbeat", "Motion",
    "MotionFlag", "Opcode", "Position", "PositionFlag", "Reply", "Result", "SpeedClass", "State",
    "Summary", "Tach", "Target", "layout_of", "opcodes", "pack_command", "pack_focus", "pack_heartbeat",
    "pack_motion", "pack_position", "pack_reply", "pack_summary", "pack_tach", "pack_target",
    "unpack_command", "unpack_focus", "unpack_heartbeat", "unpack_motion", "unpack_position",
    "unpack_reply", "unpack_summary", "unpack_tach", "unpack_target",
]  # fmt: skip
