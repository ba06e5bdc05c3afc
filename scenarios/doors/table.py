"""The doors there are, one row of table.yaml each.

A new door is a file beside this one, with a class that is a `Door`, and a row. Then `schmidt serve` has its
option, and `schmidt host`, too, when it stands on the host program.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import yaml

from scenarios.doors.options import DoorOptions
from scenarios.native.modules import PACKAGE

if TYPE_CHECKING:
    from scenarios.doors.door import Door


class Asked(NamedTuple):
    """One door as it was asked for. spec: what follows its option; number: of its kind, from 0. token: for
    clients of other machines; None: made up."""

    spec: str
    number: int
    token: str | None


@dataclass(frozen=True, kw_only=True)
class DoorKind:
    """A row of table.yaml. make: the door, of what was asked for and what it stands on."""

    name: str
    form: str
    help: str
    make: Callable[[Asked, Any], Door]
    attach: Mapping[str, str] = field(default_factory=lambda: {"": "{spec}"})
    repeatable: bool = True
    extra: str | None = None


def _make(row: dict[str, Any], name: str) -> Callable[[Asked, Any], Any]:
    door, fields, expected = row.pop("door"), row.pop("with", ["spec"]), row.pop("expected", "")

    def make(asked: Asked, place: Any) -> Any:
        path, given = door, [getattr(asked, each) for each in fields]
        if isinstance(door, dict):
            word, colon, rest = asked.spec.partition(":")
            path, given = door.get(word + colon), [rest] if rest else []
            if path is None or (colon and not rest):
                raise ValueError(f'--{name} "{asked.spec}": expected {expected}')
        module, _, word = path.rpartition(".")  # imported now, as the command line needs the rows alone
        return getattr(import_module(f"{PACKAGE}scenarios.doors.{module}"), word)(*given, place)

    return make


def _kinds(place: str) -> tuple[DoorKind, ...]:
    rows = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8"))
    here = {name: row for name, row in rows.items() if row.pop("place") == place}
    return tuple(DoorKind(name=name, make=_make(row, name), **row) for name, row in here.items())


ON_NETWORK, ON_HOST = _kinds("network"), _kinds("host")


def asked(kinds: Sequence[DoorKind], options: DoorOptions) -> list[tuple[DoorKind, Asked]]:
    """What the options ask for of these kinds, in the table's order."""
    return [
        (kind, Asked(spec, number, options.token))
        for kind in kinds
        for number, spec in enumerate(options.asked.get(kind.name, ()))
    ]


def doors_on(kinds: Sequence[DoorKind], options: DoorOptions, place: Any) -> list[Door]:
    """Those that the options ask for, closed. Raises ValueError subclasses for what cannot be meant."""
    return [kind.make(each, place) for kind, each in asked(kinds, options)]


def named(kinds: Iterable[DoorKind], joined: str) -> str:
    """Their options in a sentence: `--lx200, --alpaca and --console`."""
    *most, last = [f"--{kind.name}" for kind in kinds]
    return f"{', '.join(most)} {joined} {last}"
