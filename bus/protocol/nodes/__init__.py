"""Boards whose protocol is declared instead of written out: one `Kind` and one small DBC each."""

from bus.protocol.nodes.codec import FrameCodec
from bus.protocol.nodes.kind import Kind, KindError, ParameterRow, check_kind, kind_of
from bus.protocol.nodes.kinds import AUXILIARY, DEVICES, DOME, KINDS, POWER, WEATHER
from bus.protocol.nodes.messages import documented, messages_of, own_messages
from bus.protocol.nodes.opcodes import Argument, arguments_of

__all__ = [
    "AUXILIARY",
    "DEVICES",
    "DOME",
    "KINDS",
    "POWER",
    "WEATHER",
    "Argument",
    "FrameCodec",
    "Kind",
    "KindError",
    "ParameterRow",
    "arguments_of",
    "check_kind",
    "documented",
    "kind_of",
    "messages_of",
    "own_messages",
]
