"""ASCOM's error numbers, and which refusal gets which."""

from typing import NoReturn

from host.telescope import Reason, Refused

NOT_IMPLEMENTED = 0x400
INVALID_VALUE = 0x401
VALUE_NOT_SET = 0x402
NOT_CONNECTED = 0x407
PARKED = 0x408
SLAVED = 0x409
INVALID_OPERATION = 0x40B
ACTION_NOT_IMPLEMENTED = 0x40C
CANCELLED = 0x40E
DRIVER = 0x500
"""First of the numbers a driver may give a meaning of its own: here, the boards do not answer."""
_REASONS = {
    Reason.BELOW_HORIZON: INVALID_OPERATION,
    Reason.LIMIT: INVALID_OPERATION,
    Reason.PARKED: PARKED,
    Reason.STATE: INVALID_OPERATION,
    Reason.SLAVED: SLAVED,
    Reason.VALUE: INVALID_VALUE,
    Reason.LOCKED: INVALID_OPERATION,
    Reason.SILENT: DRIVER,
    Reason.CANCELLED: CANCELLED,
}


class AlpacaError(Exception):
    """Something that is answered with HTTP 200 and an error number."""

    def __init__(self, number: int, message: str) -> None:
        super().__init__(message)
        self.number = number


class Malformed(Exception):
    """Something that is answered with HTTP 400: a parameter that is missing or cannot be read."""


def of_refusal(refusal: Refused) -> AlpacaError:
    """The number for a refusal."""
    return AlpacaError(_REASONS[refusal.reason], str(refusal))


def not_implemented(what: str) -> NoReturn:
    """This telescope has no such thing."""
    raise AlpacaError(NOT_IMPLEMENTED, f"{what} is not implemented")


def within(name: str, value: float, low: float, high: float) -> float:
    """The value, or INVALID_VALUE."""
    if not low <= value <= high:
        raise AlpacaError(INVALID_VALUE, f"{name} {value:g} is outside {low:g} to {high:g}")
    return value
