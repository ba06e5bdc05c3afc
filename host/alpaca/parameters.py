"""Parameters of a request: GET takes their names in any case, PUT exactly; unreadable is HTTP 400."""

import math
from collections.abc import Callable
from contextlib import suppress
from typing import TypeVar
from urllib.parse import parse_qsl

from host.alpaca.errors import Malformed

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
