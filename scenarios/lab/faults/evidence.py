"""Proof that a fault acted: when it first changed something, and what."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from bus.can import Frame
from bus.can.port import BusError, Port
from scenarios.lab.faults.layers import Laid, Stacks


@dataclass
class Evidence:
    """Of one fault, arguments in base units. at_ns: when it starts; first_ns: when it first acted, None: not
    yet; on: the frame, sample, interrupt or duty that was the first.

    may_not_act: nobody minds if it never does. where: in the scenario.
    """

    name: str
    arguments: dict[str, Any] = field(default_factory=dict)
    at_ns: int = 0
    may_not_act: bool = True
    where: str = ""
    first_ns: int | None = None
    on: str = ""

    def act(self, t_ns: int, on: str) -> None:
        """It has changed something; the first time is kept."""
        if self.first_ns is None:
            self.first_ns, self.on = t_ns, on

    @property
    def missing(self) -> bool:
        """Whether it should have acted and has not."""
        return self.first_ns is None and not self.may_not_act

    def as_json(self) -> dict[str, Any]:
        """The fields of `summary.json`, times in s."""
        first_s = None if self.first_ns is None else self.first_ns * 1e-9
        found = {"name": self.name, "arguments": self.arguments, "at_s": self.at_ns * 1e-9}
        return found | {"first_s": first_s, "on": self.on, "may_not_act": self.may_not_act}


def words(frame: Frame) -> str:
    """A frame as `frame 211#1101000000000000`."""
    return f"frame {frame.identifier:03X}#{frame.data.hex().upper()}"


class Watched(Laid):
    """Passes on what a chip reads; a sample unlike the first one shows that something moved."""

    _first: Any = None

    def __init__(self, layers: Stacks, pin: tuple[Any, str], evidence: Evidence, name: str) -> None:
        self._evidence, self._name = evidence, name
        super().__init__(layers, *pin)

    def __call__(self, t_ns: int) -> Any:
        """In the place of the pin."""
        reading = self.below(t_ns)
        if self._first is None:
            self._first = reading
        elif reading != self._first:
            self._evidence.act(t_ns, f"sample of {self._name}")
        return reading


class Errors(Laid):
    """Hears of a node's errors; they are the fault's while `mine()`."""

    def __init__(self, layers: Stacks, port: Port, evidence: Evidence, mine: Callable[[], bool]) -> None:
        self._port, self._evidence, self._mine = port, evidence, mine
        super().__init__(layers, port, "on_error")

    def __call__(self, t_ns: int, error: BusError) -> None:
        """In the place of who listens, if anybody does."""
        if error.kind and self._port.online and self._mine():
            self._evidence.act(t_ns, f"{error.kind} error at {self._port.name}")
        if self.below is not None:
            self.below(t_ns, error)
