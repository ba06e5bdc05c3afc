"""What an argument of a fault may be."""

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass
from typing import Any, Literal

from scenarios.language.units import BASE, UnitError, parse

Type = Literal[
    "node", "nodes", "sensor", "axis", "motor", "identifier", "number", "whole",
    "time", "angle", "fraction", "bitrate",
]  # fmt: skip
"""A word of the network, a number, or a quantity of `scenarios.language.units`."""


class FaultError(ValueError):
    """A fault that cannot be: one line of what is wrong and what would be right."""


@dataclass(frozen=True)
class Parameter:
    """One argument of a fault.

    default: None: it has to be given; "": it may be left out. low, high: bounds, both allowed, in the base
    unit.
    """

    name: str
    text: str
    type: Type
    _: KW_ONLY
    default: float | str | None = None
    low: float | None = None
    high: float | None = None

    @property
    def quantity(self) -> str:
        """What it is a quantity of; "" for anything else."""
        return self.type if self.type in BASE else ""

    @property
    def unit(self) -> str:
        """Base unit of its values; "" when it has none."""
        return BASE[self.quantity] if self.quantity else ""

    def read(self, value: Any, known: Mapping[str, tuple[str, ...]]) -> Any:
        """A value as given, in base units; raises FaultError. known: the words of the network by type."""
        if self.type in known:
            words = known[self.type]
            if value not in words:
                raise FaultError(f"{self.name}: {value!r} is not known; use one of {', '.join(words)}")
            return value
        if self.type == "nodes":
            return self._nodes(value, known["node"])
        return self._number(value)

    def _nodes(self, value: Any, words: tuple[str, ...]) -> list[str]:
        given = value.split(",") if isinstance(value, str) else list(value)
        wrong = [each for each in given if each not in words]
        if wrong or not given or len(set(given)) != len(given):
            raise FaultError(f"{self.name}: a list of different boards out of {', '.join(words)}")
        return given

    def _number(self, value: Any) -> float | int:
        try:
            if self.quantity and isinstance(value, str):
                number: float = parse(value, self.quantity)
            elif isinstance(value, bool):
                raise ValueError("a number")
            elif self.type in ("identifier", "whole"):
                number = int(value, 0) if isinstance(value, str) else value
                if number != int(number):
                    raise ValueError("a whole number")
                number = int(number)
            else:
                number = float(value)
        except UnitError as error:
            raise FaultError(f"{self.name}: {error}") from None
        except (TypeError, ValueError, OverflowError):
            raise FaultError(f"{self.name}: {value!r} is no number{self._range()}") from None
        if not (self.low is None or self.low <= number) or not (self.high is None or number <= self.high):
            raise FaultError(f"{self.name}: {value} is out of range{self._range()}")
        if number != number:
            raise FaultError(f"{self.name}: {value} is no number{self._range()}")
        return number

    def _range(self) -> str:
        unit = f" {self.unit}" if self.unit not in ("", "1") else ""
        if self.low is None and self.high is None:
            return f", in{unit}" if unit else ""
        if self.high is None:
            return f"; at least {self.low:g}{unit}"
        return f"; {self.low:g}..{self.high:g}{unit}"
