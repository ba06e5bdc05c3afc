"""Things put on a callable or a number, several at a time, and taken away in any order."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


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
        """Put `item` on top of an attribute, or of an entry."""
        stack = self._find(owner, name)
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


def last(value: Any, items: list[Any]) -> Any:
    """The `value` that the last one gives."""
    return items[-1].value if items else value


def turned(number: float, items: list[Any]) -> float:
    """A number that each one has a `turn` at."""
    for each in items:
        number = each.turn(number)
    return number


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
