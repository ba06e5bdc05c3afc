"""The table of faults: what table.yaml tells of each, with the class that does it."""

from functools import partial
from pathlib import Path
from typing import Any

import yaml

from plant.kernels import layout as at
from scenarios.lab.faults import onboard, onbus, onchip, onplant, onsensor
from scenarios.lab.faults.kind import Kind, Parameter

_MODULES = {each.__name__.rpartition(".")[2]: each for each in (onboard, onbus, onchip, onplant, onsensor)}


def _kind(name: str, row: dict[str, Any]) -> Kind:
    parameters = tuple(Parameter(each, **given) for each, given in row.pop("arguments", {}).items())
    one_of = tuple(row.pop("one_of", ()))
    module, _, word = row.pop("does").partition(".")
    places = tuple(sum(getattr(at, part) for part in each.split(" + ")) for each in row.pop("places", ()))
    first = [*row.pop("with", ()), *([places] if places else [])]
    make = partial(getattr(_MODULES[module], word), *first)
    return Kind(name=name, parameters=parameters, make=make, one_of=one_of, **row)


_ROWS: dict[str, Any] = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8"))
KINDS: tuple[Kind, ...] = tuple(_kind(name, row) for name, row in _ROWS.items())
BY_NAME = {kind.name: kind for kind in KINDS}
