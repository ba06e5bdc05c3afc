"""How a command ends that does not end well: one line and a status."""

import sys
from typing import NoReturn

import click

UNUSABLE = 2
INTERRUPTED = 130
_LINE = 600
"""Longer messages quote somebody's megabyte."""


def fail(text: str, status: int) -> NoReturn:
    """Say `schmidt: text` on stderr, in one line, and leave with `status`."""
    text = " ".join(text.split())
    if len(text) > _LINE:
        text = text[: _LINE // 2] + " … " + text[-_LINE // 2 :]
    click.echo(f"schmidt: {text}".encode(errors="backslashreplace").replace(b"\0", b"\\0"), err=True)
    sys.exit(status)
