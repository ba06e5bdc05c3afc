"""Things put on a callable or a number, several at a time, taken away in any order; proof that they acted."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from bus.can import Frame
from bus.can.port import BusError, Port
from plant.kernels import layout as at

if TYPE_CHECKING:
    from scenarios.lab.network import Network


@dataclass
class _Stack:
    """What lies on one attribute. Found by identity, not by `id`: a snapshot's objects have others."""

    owner: Any
    name: Any
    base: Any
    items: list[Any]

    @property
    def held(self) -> bool:
        """Whether the attribute is an entry: of a declared board's pins, of the plant's world."""
        return isinstance(self.owner, dict | memoryview)


class Stacks:
    """Attributes that are not what they were; with the last item gone each is what it was.

    combine: what an attribute is, from what it was and the items on it, the oldest first.
    """

    def __init__(self, combine: Callable[[Any, list[Any]], Any]) -> None:
        self._combine = combine
        self._stacks: list[_Stack] = []

    def add(self, owner: Any, name: Any, item: Any) -> None:
        """Put `item` on top of an attribute, or of an entry; a `Staged` one below, so that it comes later."""
        stack = self._find(owner, name)
        if isinstance(item, Staged):
            stack.items.insert(0, item)
            stack.items.sort(key=lambda each: not each.last)
        else:
            stack.items.append(item)
        self._put(stack)

    def remove(self, owner: Any, name: Any, item: Any) -> None:
        """Take `item` away, wherever it lies."""
        stack = self._find(owner, name)
        stack.items = [each for each in stack.items if each is not item]
        self._put(stack)

    def _find(self, owner: Any, name: Any) -> _Stack:
        for stack in self._stacks:
            if stack.owner is owner and stack.name == name:
                return stack
        stack = _Stack(owner, name, None, [])
        stack.base = owner[name] if stack.held else getattr(owner, name)
        self._stacks.append(stack)
        return stack

    def _put(self, stack: _Stack) -> None:
        value = self._combine(stack.base, stack.items)
        if stack.held:
            stack.owner[stack.name] = value
        else:
            setattr(stack.owner, stack.name, value)
        if not stack.items:
            self._stacks = [each for each in self._stacks if each is not stack]


def chained(call: Any, layers: list[Any]) -> Any:
    """The topmost layer; each calls the one `below` it."""
    for layer in layers:
        layer.below = call
        call = layer
    return call


def turned(value: Any, items: list[Any]) -> Any:
    """A number, or a setting, that each one has a `turn` at."""
    for each in items:
        value = each.turn(value)
    return value


class Laid:
    """A fault that is called in the place of what is `below` it, until it is cleared."""

    below: Callable[..., Any]

    def __init__(self, layers: Stacks, owner: Any, name: str) -> None:
        self._layers, self._place = layers, (owner, name)
        layers.add(owner, name, self)

    def __call__(self, *arguments: Any) -> Any:
        """In the place of `below`."""
        raise NotImplementedError

    def clear(self, _t_ns: int) -> None:
        """Out of the way again."""
        self._layers.remove(*self._place, self)


@dataclass
class Evidence:
    """That one fault acted. Arguments in base units. at_ns: when it starts; first_ns: when it first changed
    something, None: not yet; on: the frame, sample, interrupt or duty that was the first.

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


AXES = {"ra": 0, "dec": 1}
"""Axis to its row of the plant's world."""


class Staged(Laid):
    """Between the PWM of an axis board and its motors: gives other duties, 0..1 each, than are wanted."""

    last = False
    """Whatever else lies there, this has the last word."""

    def __init__(self, network: "Network", axis: str, evidence: Evidence, t_ns: int) -> None:
        boards: Any = network.boards
        self._pwm = boards[f"AXIS_{axis.upper()}"].pwm
        self._axis, self._evidence, self._queue = axis, evidence, network.queue
        above, place = self._pwm.drive, AXES[axis] * at.WIDTH + at.DUTY
        written = network.plant.view[place], network.plant.view[place + 1]
        self._wanted: tuple[float, float] = above._wanted if isinstance(above, Staged) else written
        super().__init__(network.layers, self._pwm, "drive")
        self._again(t_ns, self._pwm.drive)

    def __call__(self, t_ns: int, duty_a: float, duty_b: float) -> None:
        """In the place of the pin."""
        self._wanted = duty_a, duty_b
        duties = self.duties(self._wanted)
        if duties != self._wanted:
            self._evidence.act(t_ns, f"duties of {self._axis}")
        self.below(t_ns, *duties)

    def duties(self, wanted: tuple[float, float]) -> tuple[float, float]:
        """Of motors A and B."""
        raise NotImplementedError

    def clear(self, t_ns: int) -> None:
        """The switches obey again: what was written last counts."""
        above = self._pwm.drive
        super().clear(t_ns)
        self._again(t_ns, above)

    def _again(self, t_ns: int, above: "Staged") -> None:
        self._pwm.drive(t_ns, *above._wanted)


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
