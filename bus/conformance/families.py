"""What is sent to boards of one family, as the table `families.yaml` beside this module says."""

from pathlib import Path
from typing import Any, NamedTuple

import yaml

from bus.protocol import Opcode, Result

Command = tuple[Opcode, tuple[int, ...]]
"""An opcode and its arguments."""


class Case(NamedTuple):
    """A command with arguments, the results that are right, and whether it powers or moves something."""

    opcode: Opcode
    arguments: tuple[int, ...]
    results: tuple[Result, ...]
    moves: bool


class Family(NamedTuple):
    """The table's words, which are explained there."""

    commands: tuple[Case, ...] = ()
    out_of_range: tuple[Command, ...] = ()
    at: tuple[Command, ...] = ()
    beyond: tuple[Command, ...] = ()
    before: tuple[Command, ...] = ()
    refused: tuple[Command, ...] = ()
    after: tuple[Command, ...] = ()
    halt: tuple[Command, ...] = ()


def _command(text: str) -> Command:
    opcode, *arguments = text.split()
    return Opcode[opcode], tuple(map(int, arguments))


def _case(row: dict[str, Any]) -> Case:
    right = tuple(Result[word] for word in row["right"].split())
    return Case(*_command(row["send"]), right, row.get("moves", False))


def _family(row: dict[str, Any]) -> Family:
    cases = tuple(map(_case, row.pop("commands")))
    return Family(cases, **{word: tuple(map(_command, texts)) for word, texts in row.items()})


_TABLE = yaml.safe_load(Path(__file__).with_name("families.yaml").read_text("utf-8"))
FAMILIES = {name: _family(row) for name, row in _TABLE.items()}
NOTHING = Family()
"""Of a family that is not in the table."""
