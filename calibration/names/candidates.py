"""How a name makes its candidates: the domain of the columns and the sizes' units are the plant's."""

from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from calibration.arrays import Array
from calibration.balances.candidate import Candidate
from plant.effects import REGISTRY

# of a value that is tried, a small change for its refinement. ASSUMPTION
STEP = 0.1
Size = str | tuple[str, str]
"""A parameter of the effect; with a unit of its own where the balance's is another than the plant's."""


def candidate(name: str, columns: Array, *sizes: Size, domain: str | None = None, **more: Any) -> Candidate:
    """One place of an effect: `columns` (n,) or (n, k), one size each; `more`: `Candidate`'s fields."""
    effect = REGISTRY[name]
    labels = tuple((s, effect.parameter(s).unit) if isinstance(s, str) else s for s in sizes)
    wide = columns[:, None] if columns.ndim == 1 else columns
    return Candidate(name, domain or effect.domain, wide, labels, **more)


def tried(
    name: str,
    shape: Callable[[Array], Array],
    *sizes: Size,
    at: Mapping[str, tuple[float, str]],
    steps: tuple[float, ...] | None = None,
    **more: Any,
) -> Candidate:
    """A first value of a search. `shape` gives columns (n, k) of the first len(steps) values of `at`, which
    hold a number and a unit each. `steps` are small changes of them, STEP of the first one unless given. What
    is searched for must pay, unless `more` says otherwise."""
    values = [value for value, _ in at.values()]
    steps = (STEP * values[0],) if steps is None else steps
    more = {"fixed": dict(at), "shape": shape, "steps": steps, "searched": len(steps), **more}
    return candidate(name, shape(np.array(values[: len(steps)])), *sizes, **more)


def grid(
    name: str,
    shape: Callable[[Array], Array],
    *sizes: Size,
    along: tuple[str, Iterable[float], str],
    step: float = STEP,
    beside: Mapping[str, tuple[float, str]] = MappingProxyType({}),
    **more: Any,
) -> list[Candidate]:
    """`tried` at every value `along` one parameter: its name, values and unit; `step` is a part of a value.

    `beside`: parameters that are not searched for.
    """
    called, values, unit = along
    at = ({called: (float(value), unit), **beside} for value in values)
    return [tried(name, shape, *sizes, at=one, steps=(step * one[called][0],), **more) for one in at]
