"""A row of the table of faults, and what an argument of one may be."""

from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, Any, Literal, Protocol

from scenarios.language.units import BASE, UnitError, parse

if TYPE_CHECKING:
    from scenarios.lab.faults.place import Place

Type = Literal[
    "node", "nodes", "sensor", "axis", "motor", "identifier", "number", "whole",
    "time", "angle", "fraction", "bitrate",
]  # fmt: skip
"""A word of the network, a number, or a quantity of `scenarios.language.units`."""


@dataclass(frozen=True)
class Parameter:
    """One argument of a fault.

    default: None: it has to be given; "": it may be left out. low, high: both allowed, in the base unit.
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
        """A value as given, in base units; raises ValueError. known: the words of the network by type."""
        if self.type in known:
            words = known[self.type]
            if value not in words:
                raise ValueError(f"{self.name}: {value!r} is not known; use one of {', '.join(words)}")
            return value
        if self.type == "nodes":
            return self._nodes(value, known["node"])
        return self._number(value)

    def _nodes(self, value: Any, words: tuple[str, ...]) -> list[str]:
        given = value.split(",") if isinstance(value, str) else list(value)
        wrong = [each for each in given if each not in words]
        if wrong or not given or len(set(given)) != len(given):
            raise ValueError(f"{self.name}: a list of different boards out of {', '.join(words)}")
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
            raise ValueError(f"{self.name}: {error}") from None
        except (TypeError, ValueError, OverflowError):
            raise ValueError(f"{self.name}: {value!r} is no number{self._range()}") from None
        if not (self.low is None or self.low <= number) or not (self.high is None or number <= self.high):
            raise ValueError(f"{self.name}: {value} is out of range{self._range()}")
        if number != number:
            raise ValueError(f"{self.name}: {value} is no number{self._range()}")
        return number

    def _range(self) -> str:
        unit = f" {self.unit}" if self.unit not in ("", "1") else ""
        if self.low is None and self.high is None:
            return f", in{unit}" if unit else ""
        if self.high is None:
            return f"; at least {self.low:g}{unit}"
        if self.low is None:
            return f"; at most {self.high:g}{unit}"
        return f"; {self.low:g}..{self.high:g}{unit}"


Level = Literal["bus", "board", "chip", "sensor", "actuator", "plant"]


class Active(Protocol):
    """A fault that is on."""

    def clear(self, t_ns: int) -> None:
        """Take it away at `t_ns`, the present; what it has moved stays moved."""


Make = Callable[["Place", Mapping[str, Any], int], Active]
"""(where, arguments in base units, t_ns): starts it now."""


@dataclass(frozen=True)
class Kind:
    """One fault. text: what happens. cleared: what is left when it is over."""

    level: Level
    name: str
    text: str
    parameters: tuple[Parameter, ...]
    make: Make
    cleared: str = "nothing"
    one_of: tuple[str, ...] = ()
    """At least one of these has to be given."""

    def arguments(self, given: Mapping[str, Any], known: Mapping[str, tuple[str, ...]]) -> dict[str, Any]:
        """All arguments in base units, defaults filled in; raises ValueError."""
        names = [each.name for each in self.parameters]
        for name in given:
            if name not in names:
                raise ValueError(f"{self.name}: unknown argument {name!r}; use {', '.join(names) or 'none'}")
        if self.one_of and not set(self.one_of) & set(given):
            raise ValueError(f"{self.name} needs a {' or an '.join(self.one_of)}")
        values: dict[str, Any] = {}
        for each in self.parameters:
            if each.name in given:
                try:
                    values[each.name] = each.read(given[each.name], known)
                except ValueError as error:
                    raise ValueError(f"{self.name}: {error}") from None
            elif each.default is None:
                raise ValueError(f"{self.name}: {each.name} is missing ({each.text})")
            elif each.default != "":
                values[each.name] = each.default
        return values
