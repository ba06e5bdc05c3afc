"""The boards' CANopen voice, an option of a network; the documented frames stay what they are."""

from boards.canopen.dbc import canopen_dbc
from boards.canopen.dictionary import dictionary
from boards.canopen.voice import Voice

__all__ = ["Voice", "canopen_dbc", "dictionary"]
