"""The sealer's own compile helper (it may not use the plant's)."""

from collections.abc import Callable
from typing import TypeVar, cast

from numba import njit

F = TypeVar("F", bound=Callable[..., object])


def compiled(function: F) -> F:
    """Compile once, keep on disk; no reordering of sums, so traces are the same everywhere."""
    return cast(F, njit(cache=True, error_model="numpy")(function))
