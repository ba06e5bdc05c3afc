"""What a guide holds for a machine: files to write, commands to run, programs, and what they print."""

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from tests.doors.process import PROGRAM, ROOT

GUIDES = ROOT / "docs" / "guides"
_FILE = re.compile(r"^\*\*`([\w.-]+)`\*\*[^\n]*\n\n```\w+\n(.*?)^```", re.DOTALL | re.MULTILINE)
_STEP = re.compile(
    r"^```python\n(?P<program>.*?)^```|^    (?P<command>schmidt [^\n]*)", re.DOTALL | re.MULTILINE
)
_SHOWN = re.compile(r"^```text\n(.*?)^```", re.DOTALL | re.MULTILINE)


class Step(NamedTuple):
    """A command or a Python program, and the lines that the guide shows of its output."""

    code: str
    is_program: bool
    shown: tuple[str, ...]


def text_of(name: str) -> str:
    return (GUIDES / name).read_text(encoding="utf-8")


def write_files(name: str, folder: Path) -> list[str]:
    """Write the guide's files into a folder; their names."""
    found = _FILE.findall(text_of(name))
    for file, text in found:
        (folder / file).write_text(text, encoding="utf-8")
    return [file for file, _ in found]


def steps(name: str) -> Iterator[Step]:
    """Commands of indented lines and programs of fences, each with the output that follows it."""
    text = text_of(name)
    found = list(_STEP.finditer(text))
    for here, after in zip(found, [*found[1:], None], strict=True):
        shown = _SHOWN.search(text, here.end(), after.start() if after else len(text))
        lines = tuple(shown[1].splitlines()) if shown else ()
        yield Step(here["program"] or here["command"], here["program"] is not None, lines)


def run(step: Step, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a step in a folder, as a user does."""
    code = step.code if step.is_program else PROGRAM
    words = [] if step.is_program else shlex.split(step.code, comments=True)[1:]
    environment = os.environ | {"PYTHONPATH": str(ROOT), "COLUMNS": "120"}
    return subprocess.run(
        [sys.executable, "-c", code, *words],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=600,
    )
