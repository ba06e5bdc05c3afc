"""The C file with one line wrong: `python -m tests.boards.c.mutants [--count N] [--seed S]` tries some."""

import random
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import click

from boards.c.library import FirmwareError, load
from tests.boards.c.duel import AXIS_C

_CODE = re.compile(r"^ {4,}(?!\*|enum|#)[^/\"]*;")
_CONDITION = re.compile(r"^ {4,}(if|} else if|for) ")
_RULES: tuple[tuple[str, str], ...] = (
    (r"(?<=[\w)\]]) \+ (?=[\w(])", " - "),
    (r"(?<=[\w)\]]) - (?=[\w(])", " + "),
    (r" \* (?=[\w(])", " + "),
    (r" < ", " > "),
    (r" >= ", " < "),
    (r" && ", " || "),
    (r" \|\| ", " && "),
    (r" >> (?=\d)", " >> 1 + "),
    (r"\bif \((.*)\)(?= |$)", r"if (!(\1))"),
    (r"(?<=[ (-])(\d+)(?=[;,) ])", r"(\1 + 1)"),
    (r"^( +)[\w>.\[\] +-]+ [-+*/|]?= .*;$", r"\1;"),
    (r"^( +)\w+\(.*\);$", r"\1;"),
)
"""Operators turned round, a shift by one, a condition negated, a number one larger, a statement left out."""
_SEEDS = ("lab:3", "lab:7", "final:11", "lab:14", "lab:19", "lab:23")
_STEPS = "300"
_WORST_S = 3600
UNCOMPILED = "does not compile"
"""A compiler finds these, no duel: they count for nothing."""
EQUIVALENT = (
    "b->tach[k].rate_q8 = (0 + 1);",  # there, 1 + (256 d - 1 >> 2) is 64 d, as it is without the 1
    "if (b->remaining < (0 + 1)) wanted = -wanted;",  # nothing remains: the speed wanted is the gap, 0
    "can_filter((0 + 1), 0x7FF, (uint16_t)(COMMAND + device));",  # filters 0 and 1 do the same
    "int32_t top = (0 + 1);",  # only its upper bits are used
)
"""Nothing can tell these."""
_FOUND = ("tests.boards.c.duel.Difference", "boards.core.declared.BoardError")


class Mutant(NamedTuple):
    """line: its number. was, now: the line's text."""

    line: int
    was: str
    now: str


def candidates(text: str) -> Iterator[Mutant]:
    """Every line that a rule can make wrong, by every rule that can; declarations of tables are none."""
    table = False
    for number, line in enumerate(text.splitlines(), 1):
        begins = line.startswith(("static const", "struct", "enum", "const")) and "(" not in line
        table = begins or (table and not line.startswith("}"))
        if table or not (_CODE.match(line) or _CONDITION.match(line)):
            continue
        for found, put in _RULES:
            now = re.sub(found, put, line, count=1)
            if now != line:
                yield Mutant(number, line, now)


def chosen(count: int, seed: int) -> list[Mutant]:
    """So many, of different lines."""
    every = list(candidates(AXIS_C.read_text(encoding="utf-8")))
    random.Random(seed).shuffle(every)
    each = {mutant.line: mutant for mutant in every}.values()
    return [mutant for mutant in each if mutant.now.strip() not in EQUIVALENT][:count]


def found(mutant: Mutant, folder: Path) -> str:
    """What tells it from the right one: a line; "" when nothing does."""
    lines = AXIS_C.read_text(encoding="utf-8").splitlines()
    lines[mutant.line - 1] = mutant.now
    file = folder / f"line{mutant.line}.c"
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    try:
        load(file)
    except FirmwareError:
        return UNCOMPILED
    command = [
        sys.executable,
        "-m",
        "tests.boards.c.duel",
        "--file",
        str(file),
        "--steps",
        str(_STEPS),
        *_SEEDS,
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=_WORST_S)
    if done.returncode == 0:
        return ""
    told = [line for line in done.stderr.splitlines() if line.startswith(_FOUND)]
    if not told and done.returncode > 0:
        raise RuntimeError(done.stderr)
    return told[0] if told else f"ends with signal {-done.returncode}"  # it has written where it should not


@click.command()
@click.option("--count", default=20)
@click.option("--seed", default=1)
def main(count: int, seed: int) -> None:
    """Try them."""
    missed = uncompiled = 0
    with tempfile.TemporaryDirectory() as folder:
        for mutant in chosen(count, seed):
            how = found(mutant, Path(folder))
            missed += not how
            uncompiled += how == UNCOMPILED
            print(
                f"{mutant.line}: {mutant.now.strip()}\n    {how or 'NOT FOUND, was ' + mutant.was.strip()}",
                flush=True,
            )
    print(f"{count - missed - uncompiled} of {count - uncompiled} found")


if __name__ == "__main__":
    main()
