"""What a campaign varies: an input turns a share within 0..1 into a value and puts it into a scenario."""

import copy
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any

from plant.model import ModelError, get
from plant.yamltext import nearest
from scenarios.language.document import ScenarioError
from scenarios.language.load import DEFAULT_PLANT
from scenarios.language.plants import named, plant_model

Document = dict[str, Any]
FAULT = "fault"
"""The place of every fault: one is put beside the others."""
_LEVELS = 5
"""Grid points of a distribution when the campaign does not say how many."""
_LOOKED_AT = 20
"""Values of a list that are looked at before anything runs; each takes some hundredths of a second."""
_TAIL = 0.001
"""Share of either tail of a distribution that is not looked at beforehand: some reach for ever."""


@dataclass(frozen=True)
class Input:
    """name: its column. place: what it changes. draw: share within 0..1 to value, through the inverse
    distribution. put: writes a value into a scenario's plain document. values: the grid's. ends: those that
    are looked at before anything runs: of a list the first ones, of a distribution all but both tails."""

    name: str
    place: str
    draw: Callable[[float], Any]
    put: Callable[[Document, Any], None]
    values: Sequence[Any]
    ends: Sequence[Any]

    @property
    def numeric(self) -> bool:
        """Whether its values are numbers that can be ranked."""
        return all(isinstance(each, int | float) and not isinstance(each, bool) for each in self.values)


def read(given: dict[str, Any], where: str, base: Document) -> Input:
    """An input from its checked block; raises ScenarioError. base: the scenario it will change."""
    kind = next(word for word in _PUTS if word in given)
    put, default_name, number = _PUTS[kind](given[kind], where, base)
    draw, values, ends = _distribution(given, where, kind)
    if "times" in given and number is None:
        raise ScenarioError(f"{where}: a {kind} has no value to multiply; use `is`")
    factor = number if "times" in given else None
    return Input(
        name=str(given.get("name", default_name)),
        place=default_name,
        draw=draw,
        put=put if factor is None else lambda document, value: put(document, factor * value),
        values=values,
        ends=ends,
    )


Drawn = tuple[Callable[[float], Any], list[Any], list[Any]]
"""Share within 0..1 to value, the grid's values, and those that are looked at beforehand."""


def _distribution(given: dict[str, Any], where: str, kind: str) -> Drawn:
    if ("is" in given) == ("times" in given):
        raise ScenarioError(f"{where}: {kind} needs `is` or `times`: a list of values or a distribution")
    spread: Any = given.get("times", given.get("is"))
    if isinstance(spread, list):
        if "times" in given and not all(type(each) in (int, float) for each in spread):
            raise ScenarioError(f"{where}: {kind}: `times` is a list of numbers")

        def pick(share: float) -> Any:
            return spread[min(int(share * len(spread)), len(spread) - 1)]

        return pick, spread, spread[:_LOOKED_AT]
    levels = int(spread.get("levels", _LEVELS))
    inverse = _inverse(spread, where)
    whole = spread.get("whole") or kind in ("seed", "parameter")

    def draw(share: float) -> Any:
        value = inverse(share)
        if not isfinite(value):
            raise ScenarioError(f"{where}: {kind}: the distribution gives {value}, which is no number")
        return round(value) if whole else value

    return draw, [draw((k + 0.5) / levels) for k in range(levels)], [draw(_TAIL), draw(1.0 - _TAIL)]


def _inverse(spread: dict[str, Any], where: str) -> Callable[[float], float]:
    """The inverse distribution function: uniform between two numbers, or one of scipy.stats."""
    if "between" in spread:
        low, high = map(float, spread["between"])
        if not low < high:
            raise ScenarioError(f"{where}: between {low:g} and {high:g} there is nothing")
        width = high - low
        return lambda share: share * width + low
    if "distribution" not in spread:
        raise ScenarioError(f"{where}: `between` or `distribution` is missing")
    from scipy import stats  # a second of imports

    name = str(spread["distribution"])
    known = [word for word, each in vars(stats).items() if isinstance(each, stats.rv_continuous)]
    if name not in known:
        hint = nearest(name, known)
        raise ScenarioError(f"{where}: no distribution of scipy.stats is called {name!r}; {hint}")
    numbers = {word: float(value) for word, value in spread.get("with", {}).items()}
    try:
        law = getattr(stats, name)(**numbers)
        if not float(law.ppf(0.5)) == float(law.ppf(0.5)):
            raise ValueError("its parameters are out of range")
    except TypeError:  # of a signature nobody knows
        shapes = getattr(stats, name).shapes
        more = f" and {shapes}" if shapes else ""
        raise ScenarioError(f"{where}: {name}: takes loc, scale{more}") from None
    except ValueError as error:
        raise ScenarioError(f"{where}: {name}: {' '.join(str(error).split())}") from None
    return lambda share: float(law.ppf(share))


Put = tuple[Callable[[Document, Any], None], str, float | None]
"""Writer of a value, name of its column, and the number that `times` multiplies, if there is one."""


def _plant(path: Any, where: str, base: Document) -> Put:
    """A number of the plant file, by the file's own paths; `times` is relative to what the scenario has."""
    whole = named(base.get("plant", DEFAULT_PLANT))
    try:
        number = get(plant_model(whole, Path(base["_folder"])), str(path)).value
    except ModelError as error:
        raise ScenarioError(f"{where}: {error}") from None

    def put(document: Document, value: Any) -> None:
        given = named(document.get("plant", DEFAULT_PLANT))
        document["plant"] = {**given, "overrides": {**given.get("overrides", {}), str(path): float(value)}}

    return put, str(path), number


def _at(path: Sequence[str], where: str, read: Callable[[Any], Any]) -> Callable[[Document, Any], None]:
    """Writes a value, as `read` makes it, at a path whose blocks need not be there."""

    def put(document: Document, value: Any) -> None:
        for word in path[:-1]:
            document = document.setdefault(word, {})
        try:
            document[path[-1]] = read(value)
        except (TypeError, ValueError, OverflowError):
            what = "a whole number" if read is _whole else "a number"
            raise ScenarioError(f"{where}: {'.'.join(path)}: expected {what}, found {value!r}") from None

    return put


def _whole(value: Any) -> int:
    """A whole number; ValueError for a part of one."""
    if int(value) != value:
        raise ValueError(value)
    return int(value)


def _fault(_given: Any, where: str, base: Document) -> Put:
    """One of a list of faults as scenarios have them; `none` is one, too."""

    def put(document: Document, value: Any) -> None:
        if value != "none":
            document["faults"] = [*document.get("faults", []), copy.deepcopy(value)]

    return put, FAULT, None


def _field(path: Any, where: str, base: Document) -> Put:
    """Any field of the scenario, by its path (steps.1.goto.target)."""
    parts = str(path).split(".")
    words = [int(part) if re.fullmatch("[0-9]{1,6}", part) else part for part in parts]

    def put(document: Document, value: Any) -> None:
        place: Any = document
        for word in words[:-1]:
            place = place[word]
        place[words[-1]] = value

    try:
        put(copy.deepcopy(base), 0)
    except (KeyError, IndexError, TypeError):
        raise ScenarioError(f"{where}: the scenario has no field {path!r}") from None
    return put, str(path), None


_PUTS: dict[str, Callable[[Any, str, Document], Put]] = {
    "plant": _plant,
    "parameter": lambda given, where, base: (
        _at(("network", "nodes", given["node"], "parameters", str(given["number"])), where, _whole),
        f"{given['node']} parameter {given['number']}",
        None,
    ),
    "seed": lambda given, where, base: (_at(("seed",), where, _whole), "seed", None),
    "start": lambda axis, where, base: (
        _at(("start", axis), where, lambda value: f"{float(value)!r} deg"),
        f"start, {axis.replace('_', ' ')}",
        None,
    ),
    "fault": _fault,
    "field": _field,
}
"""start: where an axis of the telescope stands at first, degrees."""
