"""Why the telescope does not do something, in a form each door can translate into its own numbers."""

from enum import Enum


class Reason(Enum):
    """What stands in the way."""

    BELOW_HORIZON = "below the horizon limit"
    LIMIT = "beyond a soft limit"
    PARKED = "parked"
    STATE = "not possible in this state"
    SLAVED = "the dome follows the telescope"
    VALUE = "out of range"
    LOCKED = "the console is locked"
    SILENT = "no answer"
    CANCELLED = "cancelled"


class Refused(ValueError):
    """A command that was not carried out; `reason` for programs, the text for people."""

    def __init__(self, reason: Reason, text: str) -> None:
        super().__init__(text)
        self.reason = reason
