"""A row of the table of faults."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, Protocol

from scenarios.lab.faults.parameter import FaultError, Parameter
from scenarios.lab.faults.place import Place

Level = Literal["bus", "board", "chip", "sensor", "actuator", "plant"]


class Active(Protocol):
    """A fault that is on."""

    def clear(self, t_ns: int) -> None:
        """Take it away at `t_ns`, the present; what it has moved stays moved."""


Make = Callable[[Place, Mapping[str, Any], int], Active]
"""(where, arguments in base units, t_ns): starts it now."""


@dataclass(frozen=True)
class Kind:
    """One fault. text: what happens. cleared: what is left when it is over. source: of its constants."""

    level: Level
    name: str
    text: str
    parameters: tuple[Parameter, ...]
    make: Make
    cleared: str = "nothing"
    one_of: tuple[str, ...] = ()
    """At least one of these has to be given."""

    def arguments(self, given: Mapping[str, Any], known: Mapping[str, tuple[str, ...]]) -> dict[str, Any]:
        """All arguments in base units, defaults filled in; raises FaultError."""
        by_name = {each.name: each for each in self.parameters}
        for name in given:
            if name not in by_name:
                raise FaultError(
                    f"{self.name}: unknown argument {name!r}; use {', '.join(by_name) or 'none'}"
                )
        if self.one_of and not set(self.one_of) & set(given):
            raise FaultError(f"{self.name} needs a {' or an '.join(self.one_of)}")
        values: dict[str, Any] = {}
        for each in self.parameters:
            if each.name in given:
                try:
                    values[each.name] = each.read(given[each.name], known)
                except FaultError as error:
                    raise FaultError(f"{self.name}: {error}") from None
            elif each.default is None:
                raise FaultError(f"{self.name}: {each.name} is missing ({each.text})")
            elif each.default != "":
                values[each.name] = each.default
        return values
