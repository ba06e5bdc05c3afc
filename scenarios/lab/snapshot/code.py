"""Functions made inside functions, by their place in their module's source; who stands for somebody outside.

A plant's pin is a closure, a parameter's getter a lambda: pickle finds neither by name. Here a function is
its module, the number of its code among the module's, and its cells. The source is the same by the digest
that a snapshot carries.
"""

import sys
from collections.abc import Callable, Iterator
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from types import CellType, CodeType, FunctionType
from typing import Any


def _walk(code: CodeType) -> Iterator[CodeType]:
    yield code
    for each in code.co_consts:
        if isinstance(each, CodeType):
            yield from _walk(each)


@cache
def codes(module: str) -> tuple[CodeType, ...]:
    """All code of a module, in the order of its source."""
    spec = find_spec(module)
    loader: Any = None if spec is None else spec.loader
    found = None if loader is None or not hasattr(loader, "get_code") else loader.get_code(module)
    return () if found is None else tuple(_walk(found))


def importable(function: FunctionType) -> bool:
    """Whether pickle finds the function by its name."""
    found: Any = sys.modules.get(function.__module__)
    for part in function.__qualname__.split("."):
        found = getattr(found, part, None)
    return found is function


def place(function: FunctionType) -> tuple[str, int]:
    """Module and number of a function's code; raises ValueError when it is not there."""
    return function.__module__, codes(function.__module__).index(function.__code__)


def cell() -> CellType:
    """A cell that is not filled yet: cells and functions may refer to each other."""
    return CellType()


def fill(cell: CellType, state: tuple[Any]) -> None:
    """Fill it. In a tuple, since pickle takes None for no state at all."""
    (cell.cell_contents,) = state


def function(module: str, number: int, cells: tuple[CellType, ...]) -> FunctionType:
    """The function again."""
    return FunctionType(codes(module)[number], vars(import_module(module)), closure=cells or None)


def finish(made: FunctionType, state: tuple[Any, ...]) -> None:
    """Defaults and attributes."""
    made.__defaults__, made.__kwdefaults__, attributes, made.__qualname__ = state
    made.__dict__.update(attributes)


def nothing(*_arguments: Any) -> None:
    """What nobody does with what it is told."""


class Nobody:
    """In the place of a door, a log or a host: whatever it is called by, it does nothing."""

    def __getattr__(self, name: str) -> Callable[..., None]:
        if name.startswith("__"):
            raise AttributeError(name)
        return nothing

    def __call__(self, *_arguments: Any) -> None:
        """Nothing."""
