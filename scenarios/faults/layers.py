"""Things put in the place of a callable or a number, several at a time, and taken away in any order."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol


class Layer(Protocol):
    """What lies between a pin and who reads it. `below` is set by the stack."""

    below: Callable[..., Any]

    def __call__(self, *arguments: Any) -> Any:
        """In the place of `below`."""


def _get(owner: Any, name: str) -> Any:
    """A pin: an attribute, or an entry of a declared board's pins."""
    return owner[name] if isinstance(owner, dict) else getattr(owner, name)


class Layers:
    """Stacks of layers on attributes; with the last layer gone the attribute is what it was."""

    def __init__(self) -> None:
        self._stacks: dict[tuple[int, str], tuple[Any, Any, list[Layer]]] = {}

    def add(self, owner: Any, name: str, layer: Layer) -> None:
        """Put `layer` on top of the attribute."""
        key = id(owner), name
        if key not in self._stacks:
            self._stacks[key] = (owner, _get(owner, name), [])
        self._stacks[key][2].append(layer)
        self._join(key)

    def remove(self, owner: Any, name: str, layer: Layer) -> None:
        """Take `layer` away, wherever it lies."""
        key = id(owner), name
        layers = self._stacks[key][2]
        layers.remove(layer)
        self._join(key)
        if not layers:
            del self._stacks[key]

    def _join(self, key: tuple[int, str]) -> None:
        owner, call, layers = self._stacks[key]
        for layer in layers:
            layer.below = call
            call = layer
        if isinstance(owner, dict):
            owner[key[1]] = call
        else:
            setattr(owner, key[1], call)

    def __len__(self) -> int:
        return len(self._stacks)


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


class Values:
    """Other values of attributes: the last one given counts; with the last gone, the one of before."""

    def __init__(self) -> None:
        self._given: dict[tuple[int, str], tuple[Any, Any, list[tuple[object, Any]]]] = {}

    def add(self, owner: Any, name: str, key: object, value: Any) -> None:
        """Let the attribute be `value`, on behalf of `key`."""
        place = id(owner), name
        if place not in self._given:
            self._given[place] = (owner, getattr(owner, name), [])
        self._given[place][2].append((key, value))
        setattr(owner, name, value)

    def remove(self, owner: Any, name: str, key: object) -> None:
        """Take back what `key` gave."""
        place = id(owner), name
        _, base, given = self._given[place]
        given[:] = [each for each in given if each[0] is not key]
        setattr(owner, name, given[-1][1] if given else base)
        if not given:
            del self._given[place]
