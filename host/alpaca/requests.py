"""What a request says, as text, and the errors it is answered with: ASCOM's numbers, or HTTP 400.

GET takes names of parameters in any case, PUT exactly.
"""

import math
from collections.abc import Callable
from contextlib import suppress
from typing import NoReturn, TypeVar
from urllib.parse import parse_qsl

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


_UINT32 = 1 << 32
T = TypeVar("T", int, float)


class Parameters:
    """Of one request, as text. exact: names as they are written (PUT), or in any case (GET)."""

    def __init__(self, encoded: str, exact: bool) -> None:
        try:
            pairs = parse_qsl(encoded, keep_blank_values=True, errors="strict", max_num_fields=100)
        except ValueError as error:
            raise Malformed(f"parameters cannot be read: {error}") from None
        self._exact = exact
        self._values: dict[str, str] = {}
        for name, value in pairs:
            if self._values.setdefault(self._key(name), value) != value:
                raise Malformed(f"parameter {name[:40]} has two values")

    def _key(self, name: str) -> str:
        return name if self._exact else name.lower()

    def text(self, name: str) -> str:
        """A parameter that has to be there."""
        value = self._values.get(self._key(name))
        if value is None:
            raise Malformed(f"parameter {name} is missing")
        return value

    def number(self, name: str) -> float:
        """A finite number."""
        return self._read(name, float, "number", math.isfinite)

    def integer(self, name: str) -> int:
        """A whole number of 32 bits."""
        return self._read(name, int, "whole number of 32 bits", lambda value: -(1 << 31) <= value < 1 << 31)

    def _read(self, name: str, kind: Callable[[str], T], what: str, fits: Callable[[T], bool]) -> T:
        text = self.text(name)
        with suppress(ValueError):
            value = kind(text)
            if fits(value) and "_" not in text and text.isascii():  # Python takes more than the standard
                return value
        raise Malformed(f"{name} {text[:40]!r} is no {what}")

    def truth(self, name: str) -> bool:
        """`True` or `False`, in any case."""
        text = self.text(name)
        if text.lower() not in ("true", "false"):
            raise Malformed(f"{name} {text[:40]!r} is neither True nor False")
        return text.lower() == "true"

    def identifier(self, name: str) -> int:
        """ClientID and ClientTransactionID: 0 when absent."""
        text = self._values.get(self._key(name), "0").strip() or "0"
        if not (text.isascii() and text.isdigit() and len(text) <= 10 and int(text) < _UINT32):
            raise Malformed(f"{name} {text[:40]!r} is no number of 32 bits")
        return int(text)
