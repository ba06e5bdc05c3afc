"""Boards whose protocol is declared instead of written out: one `Kind` and one small DBC each."""

from bus.protocol.nodes.codec import FrameCodec
from bus.protocol.nodes.kind import (
    AUXILIARY,
    DEVICES,
    DOME,
    KINDS,
    POWER,
    WEATHER,
    Kind,
    KindError,
    ParameterRow,
    check_kind,
    kind_of,
)
from bus.protocol.nodes.messages import Argument, arguments_of, documented, messages_of, own_messages

__all__ = [
    "AUXILIARY", "DEVICES", "DOME", "KINDS", "POWER", "WEATHER", "Argument", "FrameCodec", "Kind",
    "KindError", "ParameterRow", "arguments_of", "check_kind", "documented", "kind_of", "messages_of",
    "own_messages",
]  # fmt: skip
