"""How a command ends that does not end well: a line, or one for each mistake of a file, and a status."""

import sys
from collections.abc import Iterable
from typing import NoReturn

import click

UNUSABLE = 2
INTERRUPTED = 130
_LINE = 600
"""Longer messages quote somebody's megabyte."""


def fail(text: str, status: int, more: Iterable[str] = ()) -> NoReturn:
    """Say `schmidt: text` on stderr, in one line, and a line for each of `more`; leave with `status`."""
    for each in (text, *more):
        said = " ".join(each.split())
        if len(said) > _LINE:
            said = said[: _LINE // 2] + " … " + said[-_LINE // 2 :]
        click.echo(f"schmidt: {said}".encode(errors="backslashreplace").replace(b"\0", b"\\0"), err=True)
    sys.exit(status)
