"""Things put in the place of a callable or a number, several at a time, and taken away in any order."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol


class Layer(Protocol):
    """What lies between a pin and who reads it. `below` is set by the stack."""

    below: Callable[..., Any]

    def __call__(self, *arguments: Any) -> Any:
        """In the place of `below`."""


@dataclass
class _Stack:
    """What lies on one attribute. Found by identity, not by `id`: a snapshot's objects have others."""

    owner: Any
    name: str
    base: Any
    items: list[Any]


class _Stacks:
    """Attributes that are not what they were."""

    def __init__(self) -> None:
        self._stacks: list[_Stack] = []

    def find(self, owner: Any, name: str) -> _Stack:
        """The stack on an attribute; a new one when there is none."""
        for stack in self._stacks:
            if stack.owner is owner and stack.name == name:
                return stack
        base = owner[name] if isinstance(owner, dict) else getattr(owner, name)
        stack = _Stack(owner, name, base, [])
        self._stacks.append(stack)
        return stack

    def put(self, stack: _Stack, value: Any) -> None:
        """Let the attribute be `value`; a stack that is empty is forgotten."""
        if isinstance(stack.owner, dict):
            stack.owner[stack.name] = value
        else:
            setattr(stack.owner, stack.name, value)
        if not stack.items:
            self._stacks = [each for each in self._stacks if each is not stack]


class Layers(_Stacks):
    """Stacks of layers on attributes; with the last layer gone the attribute is what it was.

    An attribute is a pin of a chip, or an entry of a declared board's pins.
    """

    def add(self, owner: Any, name: str, layer: Layer) -> None:
        """Put `layer` on top of the attribute."""
        stack = self.find(owner, name)
        stack.items.append(layer)
        self._join(stack)

    def remove(self, owner: Any, name: str, layer: Layer) -> None:
        """Take `layer` away, wherever it lies."""
        stack = self.find(owner, name)
        stack.items = [each for each in stack.items if each is not layer]
        self._join(stack)

    def _join(self, stack: _Stack) -> None:
        call = stack.base
        for layer in stack.items:
            layer.below = call
            call = layer
        self.put(stack, call)


class Values(_Stacks):
    """Other values of attributes: the last one given counts; with the last gone, the one of before."""

    def add(self, owner: Any, name: str, key: object, value: Any) -> None:
        """Let the attribute be `value`, on behalf of `key`."""
        stack = self.find(owner, name)
        stack.items.append((key, value))
        self.put(stack, value)

    def remove(self, owner: Any, name: str, key: object) -> None:
        """Take back what `key` gave."""
        stack = self.find(owner, name)
        stack.items = [each for each in stack.items if each[0] is not key]
        self.put(stack, stack.items[-1][1] if stack.items else stack.base)


class Dials:
    """Factors and offsets on numbers of the plant's world; with the last one gone each is what it was."""

    def __init__(self) -> None:
        self._turned: dict[int, tuple[float, list[Callable[[float], float]]]] = {}

    def add(self, view: Any, place: int, turn: Callable[[float], float]) -> None:
        """Turn the number at `place`."""
        base, turns = self._turned.setdefault(place, (view[place], []))
        turns.append(turn)
        self._set(view, place, base, turns)

    def remove(self, view: Any, place: int, turn: Callable[[float], float]) -> None:
        """Undo one turn."""
        base, turns = self._turned[place]
        turns.remove(turn)
        self._set(view, place, base, turns)
        if not turns:
            del self._turned[place]

    @staticmethod
    def _set(view: Any, place: int, base: float, turns: list[Callable[[float], float]]) -> None:
        for turn in turns:
            base = turn(base)
        view[place] = base
