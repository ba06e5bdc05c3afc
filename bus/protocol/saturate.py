"""Values that do not fit their field: the largest or smallest that does, and somebody is told.

A field that wraps turns a fast axis into one that runs backwards; a packer that raises takes the board with
it. Packing is tried first, so that what fits costs nothing.
"""

from collections.abc import Callable, Sequence
from functools import cache
from struct import Struct
from typing import Final

Clip = Callable[[], None]
"""Called once for a message in which a value was cut."""
_BITS: Final = {"b": 8, "h": 16, "i": 32, "B": 8, "H": 16, "I": 32}


def nobody() -> None:
    """Nobody is told."""


@cache
def bounds(layout: str) -> tuple[tuple[int, int], ...]:
    """(low, high) of every value of a struct layout such as `<BBiHx`."""
    found = []
    for letter in layout:
        if letter in _BITS:
            span = 1 << _BITS[letter]
            found.append((0, span - 1) if letter.isupper() else (-span // 2, span // 2 - 1))
    return tuple(found)


def fitted(layout: Struct, values: Sequence[int]) -> tuple[int, ...]:
    """The values, each within what its field of `layout` holds."""
    return tuple(
        min(max(value, low), high) for value, (low, high) in zip(values, bounds(layout.format), strict=True)
    )
