"""Command-line options that both families of blind tests have."""

import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import click

from tests.blind import finder

DEVELOPMENT = "development seeds: 1000-1999"


def options(sets: Iterable[str], seed: int, out: Path) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Return a decorator: seed, set, only, first, out, jobs, scheduler, command."""
    given = (
        click.option("--seed", type=int, default=seed, show_default=True, help=DEVELOPMENT),
        click.option(
            "--set", "name", type=click.Choice(sorted(sets)), default="everything", show_default=True
        ),
        click.option("--only", default="", help="only cases whose key contains this"),
        click.option("--first", type=int, help="only so many cases of the set, in its order"),
        click.option("--out", type=click.Path(path_type=Path), default=out, show_default=True),
        click.option("--jobs", default=min(2, os.cpu_count() or 1), show_default=True),
        click.option(
            "--scheduler", metavar="tcp://HOST:PORT", help="a Dask scheduler whose workers see --out"
        ),
        click.option(
            "--finder",
            "command",
            default=finder.COMMAND,
            show_default=True,
            help="module:function of the command line",
        ),
    )

    def decorated(command: Callable[..., Any]) -> Callable[..., Any]:
        for option in reversed(given):
            command = option(command)
        return command

    return decorated
